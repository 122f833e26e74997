"""The command line: the only place that prints, and that turns errors into exit codes."""

# SPDX-License-Identifier: GPL-3.0-or-later
