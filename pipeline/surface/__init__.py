"""The fibers' outside as one closed surface."""

# SPDX-License-Identifier: GPL-3.0-or-later
