"""What makes an engine's mesh fit for a solver."""

# SPDX-License-Identifier: GPL-3.0-or-later
