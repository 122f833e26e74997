"""What fills the air with cells: one folder an engine."""

# SPDX-License-Identifier: GPL-3.0-or-later
