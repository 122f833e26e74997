"""Tests of meshes in tiles."""

# SPDX-License-Identifier: GPL-3.0-or-later
