"""The pores between the fibers, and what follows from them."""

# SPDX-License-Identifier: GPL-3.0-or-later
