"""Draw as many inputs as one likes: ``python -m tests.security.fuzz 20000 [part of a target's name [seed]]``."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import random
import resource
import sys
import traceback
from collections.abc import Callable

from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from tests.security.inputs import TARGETS
from tests.security.pictures import TARGETS as PICTURES
from tests.security.run_folders import TARGETS as RUN_FOLDERS

MEMORY = 6 * 2**30
"""Address space [byte] that the process gets: a header that lies about its counts must not take the machine's."""


def drawing(target: Callable[[st.DataObject], None], count: int, start: int) -> tuple[Callable[[], None], list[int]]:
    """Make the function that draws `count` inputs for a target from a seed, and the list whose number counts them."""
    drawn = [0]

    @seed(start)
    @settings(max_examples=count, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(data=st.data())
    def many(data: st.DataObject) -> None:
        drawn[0] += 1
        target(data)

    return many, drawn


def main() -> int:
    """Draw inputs for every target; exit code 1 if one gave anything but a result or an error of ours."""
    count, part = int(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else ""
    start = int(sys.argv[3]) if len(sys.argv) > 3 else random.randrange(2**32)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    failed = 0
    for name, target in {**TARGETS, **PICTURES, **RUN_FOLDERS}.items():
        if part not in name:
            continue
        many, drawn = drawing(target, count, start)
        began = sum(os.times()[:4])
        try:
            many()
            outcome = "held"
        except Exception:  # whatever it is, it is what we look for
            failed += 1
            outcome = traceback.format_exc()
        # what readers do in processes of their own counts too
        spent = sum(os.times()[:4]) - began
        sys.stdout.write(f"{name}: {drawn[0]} inputs from seed {start}, {spent:.0f} s of processor time: {outcome}\n")
        sys.stdout.flush()
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
