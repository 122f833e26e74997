"""What the models say, as rows and as figures."""

# SPDX-License-Identifier: GPL-3.0-or-later
