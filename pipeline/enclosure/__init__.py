"""The mat in its duct: the air as a closed surface with named patches."""

# SPDX-License-Identifier: GPL-3.0-or-later
