"""Formulas put together: what an author says of a whole filter."""

# SPDX-License-Identifier: GPL-3.0-or-later
