"""What a mesh is like, by the solver's own definitions."""
