"""The ladder's cases, its records, and one rung of it through the whole line."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.case import read_case
from pipeline.errors import CaseError, StageError
from pipeline.mat.settings import ArraySettings
from pipeline.mesh.engines.ftetwild.engine import TetwildSettings
from validation.ladder import Rung, climb, judged, rung_case
from validation.mats import MatRun, mat_case, over_finest
from validation.records import read_records, write_records
from validation.rows import drags_of_bins
from validation.tables import filled, ladder_table, resolution_table

CASES = Path(__file__).parent.parent.parent / "cases" / "verification"
RUNG = Rung("square", 0.1, 0.0, 0.24, 9000, 0.2, 24.9, 25.2, 25.3, 24.8317, 0.0028, 1e-5, 1e-7, 200, True, 9.0, 4.0)
MAT_RUN = MatRun(1e-5, 0.6, 1, 9, 12000, 9e-6, 0.05, 1.1, 1.2, 1e-4, 1e-7, 150, True, 20.0, 6.0)


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_case_of_the_ladder_is_valid_and_says_its_question(path: Path) -> None:
    read_case(path)
    first, second = path.read_text().splitlines()[:2]
    assert first.startswith("# ")
    assert second.endswith("?") or "?" in second


def test_a_rung_scales_every_length_of_the_mesh_and_the_polygon_the_other_way() -> None:
    case = read_case(CASES / "square.toml", ("tetmesh.engine=tetwild",))
    finer = rung_case(case, 0.05, 0.5)
    assert isinstance(finer.mat, ArraySettings)
    assert isinstance(case.mat, ArraySettings)
    assert case.mat.depth is not None
    assert (finer.mat.solidity, finer.mat.depth) == (0.05, 0.5 * case.mat.depth)
    assert finer.enclosure.inlet == finer.enclosure.outlet == finer.mat.pitch
    for name in ("edge", "growth", "largest_edge"):
        assert getattr(finer.tetmesh, name) == 0.5 * getattr(case.tetmesh, name)
    assert finer.tetmesh.own(TetwildSettings).envelope == 0.5 * case.tetmesh.own(TetwildSettings).envelope
    assert finer.surface.sides == 2 * case.surface.sides
    assert finer.tetmesh.own(TetwildSettings).passes == case.tetmesh.own(TetwildSettings).passes


def test_narrow_gaps_make_the_mesh_finer() -> None:
    case = read_case(CASES / "square.toml")
    # at solidity 0.3 the pitch is 1.618 diameters, the gap 0.618
    assert rung_case(case, 0.3, 1.0).tetmesh.edge == pytest.approx(case.tetmesh.edge * 0.618 / 1.2, rel=1e-3)


def test_slip_comes_from_the_mean_free_path() -> None:
    case = rung_case(read_case(CASES / "square.toml"), 0.1, 1.0, slip=0.1)
    assert case.flow.fiber_wall == "slip"
    # 0.998 mean free paths are a tenth of the radius of 0.5 um
    assert 0.998 * case.flow.flow().mean_free_path == pytest.approx(0.05e-6)


def test_an_array_without_a_middle_row_is_refused() -> None:
    case = read_case(CASES / "square.toml", ("mat.rows=2",))
    with pytest.raises(CaseError, match="middle row"):
        rung_case(case, 0.1, 1.0)
    with pytest.raises(CaseError, match="layered"):
        mat_case(case, 1e-5, 1.0, 1)


def test_the_force_of_each_bin_is_its_total_along_the_flow() -> None:
    # three vectors per bin, total first, as OpenFOAM's forces writes them
    text = "# Force bins\n# Time\n139 (1 2 3.5) (0 0 1) (1 2 2.5) (4 5 -6) (0 0 -2) (4 5 -4)\n"
    assert drags_of_bins(text, 2) == (3.5, -6.0)


def test_records_come_back_as_they_were_written(tmp_path: Path) -> None:
    for records in ([RUNG, replace(RUNG, converged=False)], [MAT_RUN]):
        write_records(tmp_path / "some.csv", records)
        assert read_records(tmp_path / "some.csv", type(records[0])) == records


def three_rungs() -> list[Rung]:
    answers = ((0.4, 25.0), (0.2, 24.9), (0.1, 24.875))
    return [replace(RUNG, spacing=h, f_star=f, error=f / RUNG.exact - 1.0) for h, f in answers]


def test_three_rungs_are_judged_together() -> None:
    fine, found = judged(three_rungs())[0]
    assert fine.spacing == 0.1
    assert found.order == pytest.approx(2.0)


def test_the_tables_show_errors_in_percent() -> None:
    text = ladder_table(three_rungs())
    assert "| square | 0.1 | 24.832 | 25.000 (+0.68 %) |" in text
    runs = [
        replace(MAT_RUN, edge=edge, seed=seed, cfd=cfd) for seed in (1, 2) for edge, cfd in ((0.4, 2.0), (0.6, 1.9))
    ]
    assert over_finest(runs) == [(0.4, [1.0, 1.0]), (0.6, [0.95, 0.95])]
    assert "| -5 ± 0 % |" in resolution_table(runs)


def test_a_page_without_marks_is_an_error() -> None:
    with pytest.raises(StageError, match="<!-- ladder -->"):
        filled("no place here", "ladder", "table")


def test_a_coarse_rung_has_the_exact_drag_within_a_percent(tmp_path: Path) -> None:
    # three cells per diameter and curved walls; docs/verification.md shows what finer meshes reach
    case = read_case(CASES / "square.toml")
    rung = climb(rung_case(case, 0.1, 1.5), tmp_path / "run")
    assert abs(rung.error) < 0.01
    assert abs(rung.force_balance) < 1e-6
    assert abs(rung.mass_balance) < 2e-5
    # rows at either end lack a neighbour: their drag is higher
    assert min(rung.first_row, rung.last_row) > rung.f_star
