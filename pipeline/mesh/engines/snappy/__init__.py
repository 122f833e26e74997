"""The second engine: OpenFOAM's snappyHexMesh, hexahedra that are split near the fibers and moved onto them."""

# SPDX-License-Identifier: GPL-3.0-or-later
