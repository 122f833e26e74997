"""Which particles the fibers catch: trajectories through the solved flow, and the concentration they leave."""

# SPDX-License-Identifier: GPL-3.0-or-later
