"""A few kills of whole runs; ``make fuzz`` makes as many as one likes, and docs/reliability.md tells of them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import random
import sys
from pathlib import Path

import pytest

from tests.processes.kills import VARIANTS, Kills

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere less is promised")


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIANTS)
def test_a_run_that_is_killed_anywhere_leaves_nothing_and_ends_in_the_same_results(name: str, tmp_path: Path) -> None:
    if not VARIANTS[name].possible:
        pytest.skip(f"{VARIANTS[name].needs} is not on the PATH")
    kills, draw = Kills(VARIANTS[name], tmp_path), random.Random(1)
    for _ in range(3):
        kills.kill(draw)
