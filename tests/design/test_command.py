# SPDX-License-Identifier: GPL-3.0-or-later

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

from pipeline.cli.tuning import tune_case
from pipeline.errors import CaseError

CASE = """
[mat]
generator = "layered"
side = "30 um"
fiber_diameter = "1.4 um"
relaxation_slope = 0.15
[mat.stop]
coverage = 2
"""


@pytest.fixture(name="case")
def _case(tmp_path: Path) -> Path:
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    return tmp_path / "case.toml"


def tuned(case: Path, **changed: Any) -> None:
    options: dict[str, Any] = {"overrides": (), "seeds": 2, "keep": (), "as_json": False, "quiet": True}
    tune_case(case, ("solidity=8 %", "thickness=20 um"), **{**options, **changed})


def test_the_answer_alone_goes_to_the_output(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tuned(case)
    keys = tomllib.loads(capsys.readouterr().out)
    assert set(keys["mat"]) == {"relaxation_slope", "spacing", "seed", "stop"}


def test_json_and_toml_say_the_same(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tuned(case)
    keys = tomllib.loads(capsys.readouterr().out)["mat"]
    tuned(case, as_json=True)
    content = json.loads(capsys.readouterr().out)
    assert content["relaxation_slope"] == keys["relaxation_slope"]
    assert content["coverage"] == keys["stop"]["coverage"]
    assert content["measured"]["thickness"]["mean"] == pytest.approx(20e-6, rel=0.02)


def test_only_slope_and_spacing_can_be_kept(case: Path) -> None:
    with pytest.raises(CaseError, match="--keep side"):
        tuned(case, keep=("side",))
