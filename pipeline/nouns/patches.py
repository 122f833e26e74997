"""The patches of a duct."""

# SPDX-License-Identifier: GPL-3.0-or-later

INLET, OUTLET, FIBERS = "inlet", "outlet", "fibers"
SIDES = ("xmin", "xmax", "ymin", "ymax")
PATCHES = (INLET, OUTLET, *SIDES, FIBERS)
"""The patches of a duct, in the order in which they are written."""
