"""A case that is meshed in tiles by several processes, and written as OpenFOAM's processes want it."""

# SPDX-License-Identifier: GPL-3.0-or-later
