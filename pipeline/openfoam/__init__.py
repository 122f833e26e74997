"""OpenFOAM as a neighbor: its file format, its meshes, its programs. No stage of the line; stages build on it."""
