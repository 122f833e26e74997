"""Micrographs: pictures of fibers, what can be measured in them, and the picture that a twin would give."""

# SPDX-License-Identifier: GPL-3.0-or-later
