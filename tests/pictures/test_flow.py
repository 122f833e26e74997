"""The solved flow as pictures: read in the right units, and drawn with the fibers where they are."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest

from pipeline.errors import StageError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.pictures.flow import read_flow, slice_figure, streamline_figure
from pipeline.pictures.panels import write_png
from pipeline.solve.bed import Bed
from pipeline.solve.running import solve
from pipeline.solve.settings import OpenFoamSettings
from tests.openfoam import AIR
from tests.sample_meshes import duct


def written(folder: Path) -> Path:
    # 2 x 2 x 4 um, with a bar of fiber along x through the middle
    mesh = duct(cells=(4, 8, 16), size=(2e-6, 2e-6, 4e-6)).face_mesh()
    write_openfoam(mesh, folder / "case", AIR)
    return folder / "case"


def test_a_case_that_was_not_solved_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StageError, match="holds no solution"):
        read_flow(written(tmp_path), AIR.density)


@pytest.mark.openfoam
def test_the_flow_comes_in_micrometers_pascals_and_meters_per_second(tmp_path: Path) -> None:
    found = solve(written(tmp_path), tmp_path / "work", AIR, Bed(4e-12, 1e-6), OpenFoamSettings())
    flow = read_flow(tmp_path / "work", AIR.density)
    assert flow.air.bounds == pytest.approx((0, 2, 0, 2, 0, 4), abs=1e-6)
    # the bar is two of eight cells wide and of sixteen long
    assert flow.fibers.bounds == pytest.approx((0, 2, 0.75, 1.25, 1.75, 2.25), abs=1e-6)
    inlet = np.asarray(flow.air.points)[:, 2] < 1e-6
    assert np.asarray(flow.air.point_data["p"])[inlet].mean() == pytest.approx(found.pressure_drop, rel=0.02)
    assert np.asarray(flow.air.point_data["speed"])[inlet].mean() == pytest.approx(AIR.face_velocity, rel=1e-3)
    # the slice at y = 1 um cuts the bar along its length: an eighth of the picture is white
    figure = slice_figure(flow, "title")
    image = figure.axes[0].images[0].get_array()
    assert image is not None
    assert np.ma.masked_invalid(image).mask.mean() == pytest.approx(1 / 8, abs=0.02)
    write_png(figure, tmp_path / "slice.png")
    write_png(streamline_figure(flow, "title", lines=4, size=(200, 240)), tmp_path / "lines.png")
    assert (tmp_path / "lines.png").stat().st_size > 2000
