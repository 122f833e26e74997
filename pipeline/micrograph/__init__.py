"""What can be measured in micrographs, pictures of fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later
