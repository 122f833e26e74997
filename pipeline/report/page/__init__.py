"""The page of a run."""

# SPDX-License-Identifier: GPL-3.0-or-later
