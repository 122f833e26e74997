"""Numerics on plain arrays: no stage's nouns, no files."""

# SPDX-License-Identifier: GPL-3.0-or-later
