"""Cases and meshes that solvers and viewers read."""
