"""Timings that the documentation quotes: `make bench`."""
