"""A mesh made in tiles that no memory ever holds together."""

# SPDX-License-Identifier: GPL-3.0-or-later
