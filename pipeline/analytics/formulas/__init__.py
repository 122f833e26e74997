"""One formula a function: its source, its units, its range."""

# SPDX-License-Identifier: GPL-3.0-or-later
