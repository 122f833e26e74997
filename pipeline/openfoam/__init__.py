"""OpenFOAM as a neighbor: its file format, its meshes, its programs. No stage of the line; stages build on it."""

# SPDX-License-Identifier: GPL-3.0-or-later
