"""The air in tetrahedra."""
