"""Analytical models of fiber filters: pressure drop, single-fiber efficiency, and what follows from them."""

# SPDX-License-Identifier: GPL-3.0-or-later
