"""The twin of a filter: the case whose mat has what was measured on a medium, each within its tolerance."""

# SPDX-License-Identifier: GPL-3.0-or-later
