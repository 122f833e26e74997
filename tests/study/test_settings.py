# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import Any

import pytest

from pipeline.errors import CaseError
from pipeline.study.plan import plan
from pipeline.study.settings import Study, read_study

CASE = """
[mat]
generator = "layered"
side = "10 um"
fiber_diameter = "1 um"
relaxation_slope = 0.15
[mat.stop]
count = 5
"""


def written(folder: Path, text: str) -> Path:
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    path = folder / "study.toml"
    path.write_text('case = "case.toml"\n' + text, encoding="utf-8")
    return path


def made(**content: Any) -> Study:
    basic = {"case": "case.toml", "sweep": {"mat": {"relaxation_slope": [0.1, 0.2]}}, "measure": ["mat.solidity"]}
    return Study.model_validate({**basic, **content})


def test_a_grid_has_every_combination() -> None:
    study = made(sweep={"mat.relaxation_slope": [0.1, 0.2], "mat": {"side": ["5 um", "6 um", "7 um"]}})
    assert len(study.points()) == 6
    assert study.points()[1] == {"mat.relaxation_slope": 0.1, "mat.side": "6 um"}


def test_pairs_go_together() -> None:
    study = made(combine="pairs", sweep={"mat": {"side": ["5 um", "6 um"], "relaxation_slope": [0.1, 0.2]}})
    assert [tuple(point.values()) for point in study.points()] == [("5 um", 0.1), ("6 um", 0.2)]


def test_overrides_are_what_run_takes() -> None:
    study = made(set={"mat.fiber_diameter": {"distribution": "uniform", "min": "1 um", "max": "2 um"}})
    assert study.settings({"mat.side": "20 um"}) == (
        'mat.fiber_diameter={distribution = "uniform", min = "1 um", max = "2 um"}',
        'mat.side="20 um"',
    )


def test_each_seed_of_each_combination_is_a_run(tmp_path: Path) -> None:
    text = 'seeds = 3\nfirst_seed = 7\nmeasure = ["mat.solidity"]\n[sweep]\nmat.relaxation_slope = [0.1, 0.2]\n'
    tasks = plan(read_study(written(tmp_path, text)), tmp_path / "out")
    # seed by seed, so that a study that is stopped is balanced
    assert [(task.point, task.seed) for task in tasks] == [(0, 7), (1, 7), (0, 8), (1, 8), (0, 9), (1, 9)]
    assert len({task.key for task in tasks}) == len({task.name for task in tasks}) == 6


def test_a_change_of_the_case_makes_another_run(tmp_path: Path) -> None:
    text = 'seeds = 1\nmeasure = ["mat.solidity"]\n[sweep]\nmat.relaxation_slope = [0.1]\n'
    path = written(tmp_path, text)
    [before] = plan(read_study(path), tmp_path / "out")
    (tmp_path / "case.toml").write_text(CASE.replace("10 um", "11 um"), encoding="utf-8")
    [after] = plan(read_study(path), tmp_path / "out")
    assert before.name == after.name
    assert before.key != after.key


def test_every_mistake_of_a_study_is_told_at_once(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(
        "seds = 3\nseeds = 0\nuntil = 5\n[sweep]\nmat.relaxation_slope = [0.1]\n",
        encoding="utf-8",
    )
    with pytest.raises(CaseError) as caught:
        read_study(path)
    text = str(caught.value)
    for part in ("5 mistakes", "case: missing", "measure: missing", "seds: unknown key; did you mean seeds?"):
        assert part in text
    assert "seeds = 0" in text
    assert "until = 5" in text


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ({"sweep": {}}, "names no key"),
        ({"sweep": {"mat.relaxation_slope": []}}, "the list is empty"),
        ({"sweep": {"mat.seed": [1, 2]}}, "counted up from first_seed"),
        ({"set": {"mat.relaxation_slope": 0.3}}, "is set to 0.3 as well"),
        ({"combine": "pairs", "sweep": {"mat.side": ["1 um"], "mat.broken": [0.1, 0.2]}}, "lists of one length"),
        ({"measure": []}, "names nothing"),
        ({"measure": ["mat"]}, "write STAGE.NAME"),
        ({"measure": ["mat.solidity in furlongz"]}, "is no unit"),
        ({"measure": ["mst.solidity"]}, "did you mean mat?"),
        ({"measure": ["quality.cells"]}, "ends before the stage quality"),
        (
            {"reference": [{"label": "paper", "at": 0.1, "values": {"mat.solidity in %": 8.9}}]},
            "'mat.solidity in %' is not in measure",
        ),
        ({"until": "mats"}, "the stages are mat, "),
    ],
)
def test_a_study_that_is_wrong_in_itself_is_refused(content: dict[str, Any], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        made(**content)


def test_a_wrong_value_is_told_once_though_every_run_has_it(tmp_path: Path) -> None:
    text = 'measure = ["mat.solidity"]\n[set]\nmat.sde = "3 um"\n[sweep]\nmat.relaxation_slope = [0.1, 0.2, 3.0]\n'
    with pytest.raises(CaseError) as caught:
        plan(read_study(written(tmp_path, text)), tmp_path / "out")
    assert str(caught.value).count("mat.sde: unknown key") == 1
    assert "mat.relaxation_slope = 3.0" in str(caught.value)


def test_seeds_of_a_mat_without_chance_are_refused(tmp_path: Path) -> None:
    (tmp_path / "array.toml").write_text(
        '[mat]\ngenerator = "array"\narrangement = "square"\nsolidity = 0.1\nfiber_diameter = "1 um"\n',
        encoding="utf-8",
    )
    study = made(case=tmp_path / "array.toml", sweep={"mat.solidity": [0.1, 0.2]})
    with pytest.raises(CaseError, match="always the same; set 1"):
        plan(study, tmp_path / "out")


@pytest.mark.parametrize("path", sorted(Path("cases/studies").glob("*.toml")), ids=lambda path: path.stem)
def test_the_studies_that_come_along_are_right(path: Path, tmp_path: Path) -> None:
    assert plan(read_study(path), tmp_path)
