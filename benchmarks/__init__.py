"""Timings that the documentation quotes: `make bench`."""

# SPDX-License-Identifier: GPL-3.0-or-later
