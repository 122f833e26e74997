"""Numerics on plain arrays: no stage's nouns, no files."""
