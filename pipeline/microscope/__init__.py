"""Pictures of fibers as a microscope takes them: read from a file, or taken of a mat."""

# SPDX-License-Identifier: GPL-3.0-or-later
