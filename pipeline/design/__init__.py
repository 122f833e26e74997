"""From measured filter data back to the settings of a mat."""

# SPDX-License-Identifier: GPL-3.0-or-later
