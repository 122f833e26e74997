"""Fibers go out as text and come back; a wrong file is told by line, column and reason."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
import tempfile
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.cad.fibers import write_fibers, write_spaceclaim
from pipeline.cad.lengths import in_meters, unit_of
from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.mat.exchange import read_fibers
from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.mat.settings import ArraySettings, FileSettings, LayeredSettings
from pipeline.mat.windows import cut_to
from pipeline.nouns.fibers import Mat

HEADER = "fiber,x [um],y [um],z [um],radius [nm]\n"


def file(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "fibers.csv"
    path.write_text(text, encoding="utf-8")
    return path


def small_mat(**changes: Any) -> Mat:
    asked = {"side": 20e-6, "fiber_diameter": 1e-6, "relaxation_slope": 0.15, "stop": {"count": 12}}
    return generate(LayeredSettings.model_validate(asked | changes))


@given(
    side=st.integers(10, 9_999).map(lambda tenths: tenths * 1e-7) | st.floats(1e-6, 1e-3),
    changes=st.sampled_from([{}, {"periodic": True}, {"broken": 0.5}, {"orientation": "isotropic"}]),
    seed=st.integers(0, 2**32),
)
@settings(max_examples=25)
def test_a_mat_survives_the_way_through_a_file_bit_by_bit(side: float, changes: dict[str, Any], seed: int) -> None:
    # the text's own decimal point is moved: no digit of any plan size is rounded
    mat = small_mat(side=side, seed=seed, fiber_diameter=side / 20, **changes)
    with tempfile.TemporaryDirectory() as folder:
        write_fibers(mat, Path(folder) / "fibers.csv")
        back = generate(FileSettings(file=Path(folder) / "fibers.csv"))
    assert (back.nodes == mat.nodes).all()
    assert (back.radius == mat.radius).all()
    assert (back.first == mat.first).all()
    assert (back.slab, back.periodic) == (mat.slab, mat.periodic)


@given(st.decimals("0.001", "9999.999", places=3), st.sampled_from(["nm", "um", "mm", "m", "\N{MICRO SIGN}m"]))
def test_one_length_in_two_units_is_one_float(number: Decimal, unit: str) -> None:
    other = unit_of("pm")
    shift = unit_of(unit).shift
    assert shift is not None
    assert in_meters(str(number), unit_of(unit)) == in_meters(f"{number.scaleb(shift + 12):f}", other)


@pytest.mark.parametrize("inside", [0, 1, 5])
def test_a_plan_and_an_axis_that_end_alike_fit(tmp_path: Path, inside: int) -> None:
    # 25.6 um multiplied by 1e-6 and divided by 1e6 are two floats, as for an eighth of all sizes
    for tenths in range(1, 3000, 31):
        size = f"{tenths / 10 + inside:g}"
        text = f"# plan: {size} um x {size} um\n# thickness: 6 um\n{HEADER}a,0,0,2,700\na,{size},0,2,700\n"
        mat = read_fibers(file(tmp_path, text))
        assert mat.nodes[1, 0] == mat.slab.upper[0]


@pytest.mark.parametrize(
    "head",
    [
        "# Plan: 20 um x 10 um\n# THICKNESS: 6 um\n",
        "#plan = 20 um X 10 um\n#Thickness=0.006 mm\n",
        "# PLAN:20um x10um\n# a remark: plan as drawn\n# thickness : 6000 nm\n",
        "# plan: 20 x 10 um\n# thickness: 6 um\n",
    ],
)
def test_the_slab_is_stated_in_any_case_and_spacing(tmp_path: Path, head: str) -> None:
    mat = read_fibers(file(tmp_path, head + "Fiber,X [um],Y [um],Z [um],RADIUS [nm]\na,0,5,2,700\na,9,5,2,700\n"))
    assert mat.slab.upper == (2e-5, 1e-5, 6e-6)


WINDOW = "# plan: 10 um x 10 um\n# thickness: 5 um\n" + HEADER


def test_fibers_that_leave_the_slab_are_cut_where_they_do(tmp_path: Path) -> None:
    # through both sides; out and in again; beside the window; up through its top
    rows = "a,-5,5,2,500\na,15,5,2,500\nb,2,8,2,500\nb,12,8,2,500\nb,12,9,2,500\nb,2,9,2,500\n"
    path = file(tmp_path, WINDOW + rows + "c,-1,-1,2,500\nc,20,-1,2,500\nd,5,1,1,500\nd,5,2,9,500\n")
    told: list[str] = []
    mat = read_fibers(path, outside="cut", progress=lambda what, done=None: told.append(what))
    assert (mat.nodes * 1e6).tolist() == [
        *([0, 5, 2], [10, 5, 2]),
        *([2, 8, 2], [10, 8, 2]),
        *([10, 9, 2], [2, 9, 2]),
        *([5, 1, 1], pytest.approx([5, 1.5, 5])),
    ]
    assert mat.nodes[1, 0] == mat.slab.upper[0]
    assert mat.nodes[-1, 2] == mat.slab.upper[2]
    assert told == ["cut at the slab: 4 pieces of 3 of 4 fibers lie within"]
    with pytest.raises(CaseError, match=r'line 4, column x: -5 um lies outside.*mat\.outside = "cut"'):
        read_fibers(path)


@given(st.integers(0, 2**32))
def test_what_is_cut_lies_within_and_misses_nothing(seed: int) -> None:
    # the length within the box, by the share of many points on the lines that it holds
    rng = np.random.default_rng(seed)
    box = Box((0.0, 0.0, 0.0), (1.0, 0.7, 0.4))
    lines = [rng.uniform(-0.5, 1.5, (rng.integers(2, 8), 3)) for _ in range(3)]
    first = np.cumsum([0, *map(len, lines)])
    nodes, pieces, owner = cut_to(box, np.concatenate(lines), first)
    assert (nodes >= box.lower).all()
    assert (nodes <= box.upper).all()
    length = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    length[pieces[1:-1] - 1] = 0.0
    expected = 0.0
    for line in lines:
        share = np.linspace(0, 1, 2001)[:-1] + 0.00025
        for start, end in itertools.pairwise(line):
            points = start + share[:, None] * (end - start)
            inside = ((points >= 0) & (points <= box.upper)).all(axis=1)
            expected += float(np.linalg.norm(end - start)) * inside.mean()
    assert length.sum() == pytest.approx(expected, abs=0.02)
    assert (np.diff(owner) >= 0).all()


def test_a_window_without_fibers_is_told(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="none of the 1 fibers has its axis within"):
        read_fibers(file(tmp_path, WINDOW + "a,20,20,2,500\na,30,30,2,500\n"), outside="cut")


def test_a_periodic_plan_is_not_cut(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="a periodic plan cuts no fiber"):
        read_fibers(file(tmp_path, WINDOW + "a,2,2,2,500\na,3,3,2,500\n"), periodic=True, outside="cut")


def test_a_radius_per_point_becomes_the_one_that_keeps_the_volume(tmp_path: Path) -> None:
    # a cone from .5 to .4 um: (r^2 + r s + s^2) / 3; a fiber with one radius keeps it to the last digit
    told: list[str] = []
    text = HEADER + "a,0,5,2,500\na,9,5,2,400\nb,0,7,2,333.3\nb,9,7,2,333.3\n"
    mat = read_fibers(file(tmp_path, text), side=1e-5, progress=lambda what, done=None: told.append(what))
    assert mat.radius.tolist() == [pytest.approx(1e-6 * ((0.25 + 0.2 + 0.16) / 3) ** 0.5), 333.3e-9]
    assert told == ["1 fibers vary in radius, by up to 25%: each gets the one of its volume"]


def test_a_plan_that_is_no_square_survives_too(tmp_path: Path) -> None:
    array = generate(ArraySettings(arrangement="square", solidity=0.1, fiber_diameter=1e-6, rows=2, depth=0.5e-6))
    write_fibers(array, tmp_path / "array.csv")
    assert measure(read_fibers(tmp_path / "array.csv")).solidity == pytest.approx(0.1)


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
        (HEADER + "1,0,0,1,200\n1,1,1,1,500\n", "line 3, column radius: fiber 1 changes its radius from 0.2 to 0.5 um"),
        (HEADER + "1,0,0,1,500\n1,1,2_0,1,500\n", r"line 3, column y \[um\]: '2_0' is not a number"),
        (
            HEADER + "1,0,0,1,500\n1,1,1,1,500\n2,1,1,1,500\n2,0,0,1,500\n",
            "line 4, column fiber: fiber 2 has the same points",
        ),
        ("# plan: 1 um x 1 um\n#PLAN = 2 um x 2 um\n" + HEADER, "line 2: # plan: is stated again, first on line 1"),
        ("# thicknes: 3 um\n" + HEADER, "line 1: # thicknes: states nothing; did you mean # thickness: ?"),
        ("# periodic: maybe\n" + HEADER, "line 1: write # periodic: yes, not 'maybe'"),
        ("# plan: 1_0 um x 10 um\n" + HEADER, "line 1: write # plan:"),
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
