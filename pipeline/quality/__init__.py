"""What a mesh is like, by the solver's own definitions."""

# SPDX-License-Identifier: GPL-3.0-or-later
