"""Tomograms: from gray voxels to the closed surface of the solid."""

# SPDX-License-Identifier: GPL-3.0-or-later
