"""A mesh that came out flawed, where another run of the same engine may do better."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.errors import StageError


class FlawedMeshError(StageError):
    """What an engine made cannot be used; one that differs each time is run again before this reaches a user."""
