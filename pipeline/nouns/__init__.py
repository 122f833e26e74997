"""What flows from stage to stage. A thing that exists is valid: it is checked once, when it is made, and frozen.

Arrays are read-only. Lengths are in meters, angles in radians, everything else in SI.
"""

# SPDX-License-Identifier: GPL-3.0-or-later
