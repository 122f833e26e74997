"""What an engine may use of this machine."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import psutil

_MEMORY_SHARE = 0.85  # of the machine's memory, where the case names no limit


@dataclass(frozen=True, slots=True)
class Limits:
    """What an engine may use: seconds, and bytes of memory."""

    seconds: float
    memory: float


def memory_allowed(limit: float | None) -> float:
    """Give the limit of a case [byte], or most of the machine's memory where it names none."""
    return limit or _MEMORY_SHARE * psutil.virtual_memory().total
