"""The fibers' outside as one closed surface."""
