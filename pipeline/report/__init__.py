"""One page that says what was made and whether to trust it, and one scene to turn."""

# SPDX-License-Identifier: GPL-3.0-or-later
