"""The stage on a flow that is known: its files, tables and drawings."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path

import numpy as np
import pytest

from pipeline.analytics.settings import FlowSettings
from pipeline.capture.capture import capture
from pipeline.capture.make import write_caught
from pipeline.capture.settings import CaptureSettings
from pipeline.capture.tables import capture_tables, share
from pipeline.line import store
from pipeline.nouns.capture import Capture
from pipeline.report.page.capture_section import depth_chart, efficiency_chart, penetration_chart
from tests.capture.media import SPEED, straight_fibers

LISTS = (
    "particle_diameter", "efficiency", "low", "high", "penetration", "released", "captured", "passed", "timed_out",
    "single_fiber", "first_row",
)  # fmt: skip


def test_the_file_has_a_list_per_size_and_comes_back_as_it_was(tmp_path: Path) -> None:
    sizes = (30e-9, 300e-9, 3e-6)
    settings = CaptureSettings(particle_diameters=sizes, particles=200)
    found, caught = capture(straight_fibers(), settings, FlowSettings(face_velocity=SPEED))
    path = tmp_path / "capture.json"
    store.write_json(path, found)
    content = json.loads(path.read_text())
    assert all(len(content[name]) == len(sizes) for name in LISTS)
    assert all(len(values) == len(sizes) for values in content["by_mechanism"].values())
    assert store.load_json(Capture, path) == found

    import pyvista

    write_caught(caught, tmp_path / "captured.vtp")
    points = pyvista.read(tmp_path / "captured.vtp")
    assert points.n_points == sum(found.captured)
    assert np.asarray(points.points) == pytest.approx(caught.place, abs=1e-11)
    assert set(points.point_data.keys()) == {"particle_diameter", "fiber", "time"}

    table, words = capture_tables(found)
    assert [row[0] for row in table.rows] == ["30 nm", "300 nm", "3 um"]
    assert any("EN 1822" in row[0] for row in words.rows)
    model = straight_fibers().model
    for drawing in (
        efficiency_chart(found, model, FlowSettings(face_velocity=SPEED)), penetration_chart(found), depth_chart(found)
    ):  # fmt: skip
        assert drawing.startswith("<svg")


def test_where_nothing_is_caught_the_file_of_places_is_empty_and_still_a_file(tmp_path: Path) -> None:
    import pyvista

    settings = CaptureSettings(particle_diameters=(1e-9,), particles=3, mechanisms=("interception",))
    medium = straight_fibers(x=(0.1e-6,))
    found, caught = capture(medium, settings, FlowSettings(face_velocity=SPEED))
    assert len(caught.place) == found.captured[0]
    write_caught(caught, tmp_path / "captured.vtp")
    assert pyvista.read(tmp_path / "captured.vtp").n_points == found.captured[0]


@pytest.mark.parametrize(
    ("value", "words"),
    [(0.0, "0 %"), (1.0, "100 %"), (0.123456, "12.3 %"), (0.9999971, "99.99971 %"), (3.2e-5, "0.0032 %")],
)
def test_a_share_keeps_the_digits_that_tell_it_from_nothing_and_from_all(value: float, words: str) -> None:
    assert share(value) == words
