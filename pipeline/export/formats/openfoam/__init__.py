"""OpenFOAM: the mesh, the complete case around it, and the way back."""

# SPDX-License-Identifier: GPL-3.0-or-later
