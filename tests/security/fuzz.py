"""Draw as many inputs as one likes: ``python -m tests.security.fuzz 20000 [part of a target's name]``."""

# SPDX-License-Identifier: GPL-3.0-or-later

import resource
import sys
import time
import traceback
from collections.abc import Callable

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.security.inputs import TARGETS
from tests.security.pictures import TARGETS as PICTURES
from tests.security.run_folders import TARGETS as RUN_FOLDERS

MEMORY = 6 * 2**30
"""Address space [byte] that the process gets: a header that lies about its counts must not take the machine's."""


def drawing(target: Callable[[st.DataObject], None], count: int) -> tuple[Callable[[], None], list[int]]:
    """Make the function that draws `count` inputs for a target, and the list whose one number counts them."""
    drawn = [0]

    @settings(max_examples=count, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(data=st.data())
    def many(data: st.DataObject) -> None:
        drawn[0] += 1
        target(data)

    return many, drawn


def main() -> int:
    """Draw inputs for every target; exit code 1 if one gave anything but a result or an error of ours."""
    count, part = int(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else ""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    failed = 0
    for name, target in {**TARGETS, **PICTURES, **RUN_FOLDERS}.items():
        if part not in name:
            continue
        many, drawn = drawing(target, count)
        began = time.perf_counter()
        try:
            many()
            outcome = "held"
        except Exception:  # whatever it is, it is what we look for
            failed += 1
            outcome = traceback.format_exc()
        sys.stdout.write(f"{name}: {drawn[0]} inputs in {time.perf_counter() - began:.0f} s: {outcome}\n")
        sys.stdout.flush()
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
