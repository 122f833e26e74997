"""Cases and meshes that solvers and viewers read."""

# SPDX-License-Identifier: GPL-3.0-or-later
