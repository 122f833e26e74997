"""Scripts to start from: as far as they can be tried without the programs that they are for."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from pipeline.nouns.patches import INLET, OUTLET

STARTERS = Path(__file__).parents[2] / "starters"


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not on the PATH")
def test_the_slurm_script_is_shell_and_asks_for_its_case() -> None:
    script = STARTERS / "slurm.sh"
    subprocess.run(["bash", "-n", str(script)], check=True)
    alone = subprocess.run(["bash", str(script)], capture_output=True, text=True, check=False)
    assert alone.returncode != 0
    assert "usage: sbatch" in alone.stderr


def test_the_journal_names_the_zones_that_our_meshes_have() -> None:
    journal = (STARTERS / "fluent.jou").read_text()
    zones = set(re.findall(r"zone-type (\w+) ", journal))
    assert zones == {INLET, OUTLET}
    assert '"mesh.msh"' in journal
