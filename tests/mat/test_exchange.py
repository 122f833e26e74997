"""Fibers go out as text and come back; a wrong file is told by line, column and reason."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.errors import CaseError
from pipeline.mat.exchange import read_fibers, write_fibers, write_spaceclaim
from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.mat.settings import ArraySettings, FileSettings, LayeredSettings
from pipeline.nouns.fibers import Mat


def small_mat(**changes: Any) -> Mat:
    asked = {"side": 20e-6, "fiber_diameter": 1e-6, "relaxation_slope": 0.15, "stop": {"count": 12}}
    return generate(LayeredSettings.model_validate(asked | changes))


@pytest.mark.parametrize("changes", [{}, {"periodic": True}, {"broken": 0.5}])
def test_a_mat_survives_the_way_through_a_file(tmp_path: Path, changes: dict[str, Any]) -> None:
    mat = small_mat(**changes)
    write_fibers(mat, tmp_path / "fibers.csv")
    back = generate(FileSettings(file=tmp_path / "fibers.csv"))
    # meters to micrometers and back: two roundings
    assert back.nodes == pytest.approx(mat.nodes, rel=1e-15, abs=1e-21)
    assert back.radius == pytest.approx(mat.radius, rel=1e-15)
    assert back.first.tolist() == mat.first.tolist()
    assert back.slab.upper == pytest.approx(mat.slab.upper, rel=1e-15)
    assert back.periodic == mat.periodic
    # what lay exactly on a side still does
    sides = [mat.nodes[:, :2] == mat.slab.upper[0], back.nodes[:, :2] == back.slab.upper[0]]
    assert (sides[0] == sides[1]).all()
    assert measure(back).solidity == pytest.approx(measure(mat).solidity)


def test_a_plan_that_is_no_square_survives_too(tmp_path: Path) -> None:
    array = generate(ArraySettings(arrangement="square", solidity=0.1, fiber_diameter=1e-6, rows=2, depth=0.5e-6))
    write_fibers(array, tmp_path / "array.csv")
    assert measure(read_fibers(tmp_path / "array.csv")).solidity == pytest.approx(0.1)


def file(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "fibers.csv"
    path.write_text(text, encoding="utf-8")
    return path


HEADER = "fiber,x [um],y [um],z [um],radius [nm]\n"


def test_columns_may_stand_in_any_order_and_each_in_its_unit(tmp_path: Path) -> None:
    text = "z [nm], radius [nm], fiber, y [mm], x [um]\n# a remark\n500,500,a,0,0\n\n500,500,a,0.01,10\n"
    mat = read_fibers(file(tmp_path, text), side=10e-6)
    assert mat.nodes == pytest.approx(np.array([[0, 0, 0.5e-6], [10e-6, 10e-6, 0.5e-6]]))
    assert mat.radius.tolist() == [0.5e-6]
    assert mat.thickness == pytest.approx(1e-6)


def test_without_a_plan_the_fibers_are_moved_to_the_corner(tmp_path: Path) -> None:
    mat = read_fibers(file(tmp_path, HEADER + "1,5,7,9,500\n1,15,27,9,500\n"))
    assert mat.slab.upper == pytest.approx((10e-6, 20e-6, 1e-6))
    assert mat.nodes[0] == pytest.approx([0, 0, 0.5e-6])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "line 1, column fiber: missing from the header"),
        ("fiber,x [um],y [um],z [um]\n", "line 1, column radius: missing"),
        ("fiber,x,y [um],z [um],radius [um]\n", r"line 1, column x: write the column's unit as x \[um\]"),
        ("fiber,x [um],x [um],z [um],radius [um]\n", r"line 1, column x \[um\]: a column stands twice"),
        ("fiber,x [um],w [um],z [um],radius [um]\n", r"line 1, column w \[um\]: unknown column"),
        (HEADER, "line 1, column fiber: no fiber follows"),
        (HEADER + "1,0,0,1,500\n", "line 2, column fiber: fiber 1 has only one point"),
        (HEADER + "1,0,0,1,500\n1,1,0\n", r"line 3, column z \[um\]: 3 values for 5 columns"),
        (HEADER + "1,0,0,1,500\n1,1,o,1,500\n", r"line 3, column y \[um\]: 'o' is not a number"),
        (HEADER + "1,0,0,1,500\n1,1,inf,1,500\n", r"line 3, column y \[um\]: 'inf' is not a finite number"),
        (HEADER + "1,0,0,1,500\n1,0,0,1,500\n", r"line 3, column x \[um\]: fiber 1 has the same point twice"),
        (HEADER + "1,0,0,1,0\n1,1,1,1,0\n", r"line 2, column radius \[nm\]: a radius must be above 0"),
        (HEADER + "1,0,0,1,500\n1,1,1,1,400\n", r"line 3, column radius \[nm\]: fiber 1 changes its radius"),
        (
            HEADER + "1,0,0,1,500\n1,1,1,1,500\n2,0,1,1,500\n2,1,0,1,500\n1,1,1,1,500\n1,2,2,1,500\n",
            "line 6, column fiber: fiber 1 goes on after another",
        ),
        ("# plan: 10 um\n" + HEADER, "line 1: write # plan: 100 um x 100 um, not '10 um'"),
        ("# plan: 10 um x 10 um\n" + HEADER + "1,0,0,1,500\n1,11,10,1,500\n", "line 4, column x: 11 um lies outside"),
        ("# thickness: 1 um\n" + HEADER + "1,0,0,1,500\n1,9,10,2,500\n", "line 4, column z: 2 um lies outside"),
        (HEADER + "1,0,5,1,500\n1,9,5,1,500\n", "no extent along y"),
    ],
)
def test_a_wrong_file_is_told_by_line_column_and_reason(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(CaseError, match=reason):
        read_fibers(file(tmp_path, text))


def test_a_plan_stated_twice_is_refused(tmp_path: Path) -> None:
    write_fibers(small_mat(), tmp_path / "fibers.csv")
    with pytest.raises(CaseError, match="states its own plan"):
        read_fibers(tmp_path / "fibers.csv", side=1e-5)


def test_a_file_that_is_not_there_or_no_text_is_told(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="cannot read"):
        read_fibers(tmp_path / "none.csv")
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CaseError, match="UTF-8"):
        read_fibers(tmp_path / "binary.csv")


def test_the_spaceclaim_list_has_start_end_and_a_point_on_the_surface(tmp_path: Path) -> None:
    mat = small_mat()
    write_spaceclaim(mat, tmp_path / "cylinders.txt")
    table = np.loadtxt(tmp_path / "cylinders.txt")
    assert table.shape == (mat.segments, 9)
    start, end, surface = table[:, :3], table[:, 3:6], table[:, 6:]
    assert np.linalg.norm(surface - end, axis=1) == pytest.approx(mat.radius[mat.segment_fibers()], rel=1e-6)
    # across the axis: to the 12 digits written, of coordinates 20 times a radius
    axis = (end - start) / mat.segment_lengths()[:, None]
    assert np.einsum("ij,ij->i", surface - end, axis) == pytest.approx(np.zeros(mat.segments), abs=1e-16)
