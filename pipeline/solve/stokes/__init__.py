"""Steady flow by Taylor-Hood elements: quadratic velocity and linear pressure on curved tetrahedra."""

# SPDX-License-Identifier: GPL-3.0-or-later
