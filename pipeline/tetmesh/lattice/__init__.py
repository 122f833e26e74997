"""Tetrahedra from a lattice: good by construction, quick, and the same every time."""
