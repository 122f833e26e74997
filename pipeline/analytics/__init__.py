"""Analytical models of pressure drop and single fiber efficiency."""
