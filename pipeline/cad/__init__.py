"""Fibers and their surface as files of drawing programs. No stage of the line; stages build on it."""

# SPDX-License-Identifier: GPL-3.0-or-later
