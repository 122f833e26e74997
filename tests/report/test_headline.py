"""The number above everything else: where it comes from, and what is known of its interval."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
from pathlib import Path

import pytest

from pipeline.nouns.comparison import Comparison
from pipeline.nouns.convergence import RESULT, Contributions, ConvergedDrop, Interval
from pipeline.report.page import words
from pipeline.report.page.as_json import page_json
from pipeline.report.page.headline import headline
from pipeline.report.page.page import filled, sections, tiles
from pipeline.report.views.render import Pictures
from tests.report.contents import CAPTURE, SOLUTION, having, whole
from tests.report.pages import read

BOTH = dataclasses.replace(SOLUTION, fiber_wall="slip", pressure_drop_slip=12.5, pressure_drop_no_slip=13.75)


def test_without_a_flow_the_models_give_the_number_and_those_in_their_range_its_interval() -> None:
    found, comparison = headline(whole()), whole().read(Comparison)
    assert found is not None
    assert found.value == comparison.models["davies"].mesh
    inside = [row.mesh for row in comparison.models.values() if not row.notes]
    assert (found.low, found.high) == (min(inside), max(inside))
    assert any("fibertwin solve" in note for note in found.notes)


def test_a_solved_flow_takes_the_place_of_the_models_and_says_what_the_other_wall_gives() -> None:
    found = headline(whole(BOTH))
    assert found is not None
    assert found.value == BOTH.pressure_drop
    assert found.what == "pressure drop, with slip on the fibers"
    # 13.75 over 12.5
    assert any("Without slip it is 13.8 Pa (+10.0%)" in note for note in found.notes)


def test_what_is_known_of_such_meshes_gives_one_mesh_an_interval() -> None:
    # such meshes were 1 % to 5 % high, so that the number is 12.5 / 1.05 to 12.5 / 1.01; what is shown lies within
    known = dataclasses.replace(BOTH, mesh_error=(0.03, 0.01, 0.05), seed_spread=0.15)
    found = headline(whole(known))
    assert found is not None
    assert (found.low, found.high) == pytest.approx((12.5 / 1.05, 12.5))
    assert any("±30%" in note for note in found.notes)
    alone = headline(whole(BOTH))
    assert alone is not None
    assert alone.interval == ""
    assert "fibertwin converge" in alone.of


def test_several_meshes_give_the_number_its_own_interval(tmp_path: Path) -> None:
    parts = Contributions(mesh=0.02, slip=0.1, box=None, seed=0.15)
    drop = ConvergedDrop("a", "stokes", "slip", Interval(12.0, 11.8, 12.3), 2.0, 12.0, (), parts, (12.0, 14.0))
    (tmp_path / RESULT).write_text(json.dumps(dataclasses.asdict(drop)))
    found = headline(whole(BOTH, folder=tmp_path))
    assert found is not None
    assert (found.value, found.low, found.high) == (12.0, 11.8, 12.3)
    assert found.interval == "11.8 to 12.3 Pa"


def test_before_there_is_any_number_none_is_told() -> None:
    assert headline(having()) is None


def test_a_flow_that_has_not_settled_or_does_not_balance_is_part_of_the_verdict() -> None:
    fit = whole(BOTH)
    assert words.whole_verdict(fit)[1].endswith("the flow has settled and balances")
    adrift = dataclasses.replace(BOTH, converged=False)
    assert words.whole_verdict(whole(adrift)) == (
        words.BAD,
        f"{words.whole_verdict(whole())[1]}, but the flow has not settled",
    )
    # a hundredth is the most that drag and pressure may differ
    off = dataclasses.replace(BOTH, force_balance_error=0.02)
    assert "does not balance" in words.whole_verdict(whole(off))[1]


def test_the_number_stands_before_everything_and_the_models_after_the_flow() -> None:
    content = whole(BOTH, CAPTURE)
    html = filled(content, sections(content), Pictures({"duct": b"a picture"}))
    page = read(html)
    order = [
        value for value in page.values("id") if value in ("summary", "mat", "mesh", "solution", "capture", "comparison")
    ]
    assert order == ["summary", "mat", "mesh", "solution", "capture", "comparison"]
    assert html.index("12.5 Pa") < html.index("Can it be trusted?")
    assert page.values("id").count("picture-duct") == 1
    assert html.index('id="picture-duct"') < html.index("Can it be trusted?")


def test_the_json_has_every_word_and_every_number_of_the_page() -> None:
    content = whole(BOTH, CAPTURE)
    made = sections(content)
    found = json.loads(json.dumps(page_json(content, made, tiles(content)), allow_nan=False))
    text = " ".join(read(filled(content, made, Pictures())).text)
    assert found["headline"]["value"] == BOTH.pressure_drop
    assert found["results"]["solution"]["pressure_drop_no_slip"] == 13.75
    assert [section["anchor"] for section in found["sections"]] == [section.anchor for section in made]
    for check in found["checks"]:
        assert check["title"] in text
    # no row of any table is missing
    for section in found["sections"]:
        for part in section["parts"]:
            for row in part.get("rows", ()):
                assert all(cell.split(" ")[0].replace("u", "µ") in text.replace("u", "µ") for cell in row), row
