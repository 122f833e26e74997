"""Tetrahedra from a lattice: good by construction, quick, and the same every time."""

# SPDX-License-Identifier: GPL-3.0-or-later
