"""Pictures of mats: from above, from the side, and in their duct, with axes in micrometers."""

# SPDX-License-Identifier: GPL-3.0-or-later
