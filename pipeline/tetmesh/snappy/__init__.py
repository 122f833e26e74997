"""The second engine: OpenFOAM's snappyHexMesh, hexahedra that are split near the fibers and moved onto them."""
