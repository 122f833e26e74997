"""Exact drag against ours: arrays of fibers through the whole line, and how far a mat's answer depends on the mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later
