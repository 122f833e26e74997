"""One file a format."""

# SPDX-License-Identifier: GPL-3.0-or-later
