"""The line from the case file to the report: its stages, their results on disk, and why each of them ran."""

# SPDX-License-Identifier: GPL-3.0-or-later
