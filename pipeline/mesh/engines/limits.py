"""What an engine may use of this machine."""

# SPDX-License-Identifier: GPL-3.0-or-later

_MEMORY_SHARE = 0.85  # of the machine's memory, where the case names no limit


def memory_allowed(limit: float | None) -> float:
    """Give the limit of a case [byte], or most of the machine's memory where it names none."""
    import psutil

    return limit or _MEMORY_SHARE * psutil.virtual_memory().total
