"""Random fiber mats: drawn, deposited, measured, exchanged."""

# SPDX-License-Identifier: GPL-3.0-or-later
