"""`fibertwin predict`: the analytical models for numbers, a case or a run."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from pipeline.analytics.models.prediction import filter_of_comparison, filter_of_mat, predict
from pipeline.analytics.options import read_options
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.analytics.tables.rows import prediction_tables, thick_tables
from pipeline.cli.tables import plain_table
from pipeline.errors import CaseError, StageError
from pipeline.line.places import disk_trouble_explained

if TYPE_CHECKING:
    from pipeline.nouns.surface import Surface


def predict_filter(source: Path | None, given: Mapping[str, str], as_json: bool, plot: Path | None) -> None:
    """Print what the models say, and draw it where a plot is asked for."""
    given = _with_one_diameter(given)
    medium, flow = read_options(given, *_known(source)) if source else read_options(given)
    if plot is not None:
        # matplotlib takes a second to load, for nobody who wants numbers only
        from pipeline.analytics.tables.plots import plot_prediction, save_figure

        with disk_trouble_explained(plot):
            save_figure(plot_prediction(medium, flow), plot)
    prediction = predict(medium, flow)
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(prediction), indent=2, allow_nan=False) + "\n")
        return
    out = Console()
    for table in prediction_tables(prediction):
        out.print(plain_table(table.title, table.columns, table.rows))


def predict_thick(folders: tuple[Path, ...], given: Mapping[str, str], as_json: bool) -> None:
    """Print what solved slabs say of a thick medium of theirs."""
    from pipeline.analytics.models.thick import slab_of, thicken
    from pipeline.line.run import Run
    from pipeline.nouns.capture import Capture
    from pipeline.nouns.fibers import Mat
    from pipeline.nouns.flow import Solution

    foreign = sorted(set(given) - {"thickness", "face_velocity"})
    if foreign:
        names = ", ".join(f"--{name.replace('_', '-')}" for name in foreign)
        raise CaseError(f"--from scales what was solved: {names} would change it; solve a slab that has it")
    if "thickness" not in given:
        raise CaseError('--from needs the thickness of the medium: --thickness "0.4 mm"')
    runs = [Run.opened(folder) for folder in folders]
    slabs = []
    for folder, run in zip(folders, runs, strict=True):
        solution = run.get(Solution)
        if solution is None:
            raise StageError(f"{folder} is not solved; fibertwin solve {folder}")
        slabs.append(slab_of(run.read(Mat), solution))
    solved = runs[0].case.flow
    for folder, run in zip(folders[1:], runs[1:], strict=True):
        if run.case.flow != solved:
            raise CaseError(f"{folder} was solved with another [flow] than {folders[0]}: the slabs are of one medium")
    typed = {"solidity": "0.1", "fiber_diameter": "1 um", "thickness": given["thickness"]}
    medium, flow = read_options({**typed, **{k: v for k, v in given.items() if k == "face_velocity"}}, flow=solved)
    ratio = flow.face_velocity / solved.face_velocity
    found = thicken(slabs, medium.thickness, flow.face_velocity, ratio, runs[0].get(Capture))
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(found), indent=2, allow_nan=False) + "\n")
        return
    out = Console()
    for table in thick_tables(found):
        out.print(plain_table(table.title, table.columns, table.rows))


_DRAWN = 200_000  # diameters that stand for a distribution: their mean square is good to a few thousandths


def _with_one_diameter(given: Mapping[str, str]) -> Mapping[str, str]:
    """Turn a distribution of diameters into that of equal fibers of the same length and volume."""
    text = given.get("fiber_diameter", "").strip()
    if not text.startswith("{"):
        return given
    import numpy as np

    from pipeline.case import override, validate
    from pipeline.mat.diameters import draw_diameters

    mat = {"generator": "layered", "side": "100 um", "relaxation_slope": 0.15, "stop": {"count": 1}}
    case = validate(override({"mat": mat}, (f"mat.fiber_diameter={text}",)), "--fiber-diameter")
    drawn = draw_diameters(case.mat.fiber_diameter, _DRAWN, np.random.default_rng(0))
    return {**given, "fiber_diameter": f"{float(np.sqrt(np.mean(drawn**2)))!r} m"}


def _known(source: Path) -> tuple[FilterSettings, FlowSettings]:
    # the line is loaded for who names a case or a run, not for who types numbers
    from pipeline.case import read_case
    from pipeline.line.run import Run
    from pipeline.mat.generate import generate
    from pipeline.mat.make import mat_predictor, named_surface
    from pipeline.nouns.comparison import Comparison
    from pipeline.nouns.fibers import Mat
    from pipeline.nouns.surface import Surface

    if source.is_dir():
        run = Run.opened(source)
        if (source / "compare").is_dir():
            return filter_of_comparison(dataclasses.asdict(run.read(Comparison))), run.case.flow
        if run.case.mat.generator == "surface":
            return _filter_of_body(run.read(Surface)), run.case.flow
        return filter_of_mat(run.read(Mat), run.case.flow.flow()), run.case.flow
    case = read_case(source)
    if case.mat.generator == "surface":
        from pipeline.surface.own import read_body

        return _filter_of_body(read_body(named_surface(case.mat))[0]), case.flow
    return filter_of_mat(generate(case.mat, mat_predictor(case)), case.flow.flow()), case.flow


def _filter_of_body(surface: "Surface") -> FilterSettings:
    """Describe a body as a filter: solidity, thickness, and the diameter of cylinders of its volume and area."""
    return FilterSettings(
        solidity=surface.solidity,
        thickness=surface.slab.size[2],
        fiber_diameter=2.0 * float(surface.radius[0]),
    )
