"""A case run many times: keys swept, seeds repeated, means with their confidence."""

# SPDX-License-Identifier: GPL-3.0-or-later
