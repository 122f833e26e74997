"""How a stage tells what it is doing, without knowing who listens."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Protocol

NOTE = "note: "
"""How that begins which is to stay where a person reads it."""


class Progress(Protocol):
    """Called by a stage whenever there is something to tell."""

    def __call__(self, what: str, done: float | None = None) -> None:
        """Tell what is being done, and which share of it, 0 to 1, where that is known."""


def silent(what: str, done: float | None = None) -> None:
    """Listen to nothing."""
