"""OpenFOAM runs of an exported case."""

# SPDX-License-Identifier: GPL-3.0-or-later
