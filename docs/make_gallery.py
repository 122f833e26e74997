"""Render the paper's pictures of mats from our own: ``python docs/make_gallery.py docs/gallery``."""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.case import Case, validate
from pipeline.geometry.box import Box
from pipeline.mat.generate import generate
from pipeline.mat.make import mat_predictor
from pipeline.mat.measures import measure
from pipeline.nouns.fibers import Mat
from pipeline.pictures.panels import duct_figure, mat_figure, write_png
from pipeline.study.pictures import draw_points
from pipeline.study.settings import read_study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURE_3 = {
    "generator": "box",
    "side": "100 um",
    "thickness": "20 um",
    "broken": 0.5,
    "fiber_diameter": {
        "distribution": "mixture",
        "parts": [
            {"weight": 0.75, "diameter": {"distribution": "uniform", "min": "200 nm", "max": "600 nm"}},
            {"weight": 0.25, "diameter": {"distribution": "uniform", "min": "2.0 um", "max": "3.5 um"}},
        ],
    },
    "seed": 3,
    "stop": {"solidity": 0.1},
}
"""Section 3.1; the paper leaves the solidity unprinted."""

FIGURE_7 = {
    "generator": "layered",
    "side": "20 um",
    "fiber_diameter": {"distribution": "lognormal", "median": "350 nm", "geometric_std": 1.25},
    "relaxation_slope": 0.15,
    "contact": "clear",
    "seed": 7,
    "stop": {"coverage": 4},
}
"""An electrospun medium without interpenetration; the paper prints no parameters."""

FIGURE_8 = Path(__file__).parent.parent / "cases" / "studies" / "figure8.toml"

FIGURE_10 = {
    "generator": "layered",
    "side": "100 um",
    "fiber_diameter": "1.4 um",
    "relaxation_slope": 0.15,
    "seed": 10,
    "stop": {"coverage": 4},
}
HEPA = {"generator": "layered", "side": "20 um", "fiber_diameter": "500 nm", "relaxation_slope": 0.15}
FIGURE_11 = {**HEPA, "seed": 11, "stop": {"pressure_drop": "320 Pa"}}
FIGURE_12 = {**HEPA, "seed": 12, "stop": {"efficiency": "99.97 %", "particle_diameter": "300 nm"}}


def _grown(settings: dict[str, Any]) -> Mat:
    case: Case = validate({"mat": settings, "flow": {"face_velocity": "2.5 cm/s", "temperature": "293 K"}}, "gallery")
    return generate(case.mat, mat_predictor(case))


def _title(mat: Mat) -> str:
    found = measure(mat)
    return f"{mat.fibers} fibers, {found.thickness * 1e6:.1f} um thick, solidity {found.solidity:.2%}"


def _top(mat: Mat) -> "Figure":
    return mat_figure(mat, "top", _title(mat), pixels=600)


def _side(mat: Mat) -> "Figure":
    return mat_figure(mat, "side", _title(mat), pixels=860 if mat.thickness < mat.slab.size[0] else 300)


def _duct(mat: Mat) -> "Figure":
    plenum = 0.5 * mat.slab.size[0]
    (x0, y0, z0), (x1, y1, z1) = mat.slab.lower, mat.slab.upper
    return duct_figure(mat, Box((x0, y0, z0 - plenum), (x1, y1, z1 + plenum)), _title(mat))


PICTURES: dict[str, tuple[dict[str, Any], Callable[[Mat], "Figure"]]] = {
    "figure_3c.png": (FIGURE_3, _top),
    "figure_7b.png": (FIGURE_7, _top),
    "figure_10a.png": (FIGURE_10, _top),
    "figure_10b.png": (FIGURE_10, _side),
    "figure_10c.png": (FIGURE_10, _duct),
    "figure_11a.png": (FIGURE_11, _top),
    "figure_11b.png": (FIGURE_11, _side),
    "figure_12a.png": (FIGURE_12, _duct),
}


def main(folder: Path) -> None:
    """Render every picture into a folder that exists."""
    draw_points(read_study(FIGURE_8), folder / "figure_8.png")
    for name, (settings, draw) in PICTURES.items():
        write_png(draw(_grown(settings)), folder / name)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
