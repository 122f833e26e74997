"""OpenFOAM runs of an exported case."""
