"""Analytical pressure drops from the nominal, the surface's and the mesh's solidity."""

# SPDX-License-Identifier: GPL-3.0-or-later
