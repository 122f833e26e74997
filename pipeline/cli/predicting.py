"""`fibertwin predict`: the analytical models for numbers, a case or a run."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import sys
from collections.abc import Mapping
from pathlib import Path

from rich.console import Console

from pipeline.analytics.models.prediction import filter_of_comparison, filter_of_mat, predict
from pipeline.analytics.options import read_options
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.analytics.tables.rows import prediction_tables
from pipeline.cli.tables import plain_table
from pipeline.line.places import disk_trouble_explained


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
    from pipeline.mat.make import mat_predictor
    from pipeline.nouns.comparison import Comparison
    from pipeline.nouns.fibers import Mat

    if source.is_dir():
        run = Run.opened(source)
        if (source / "compare").is_dir():
            return filter_of_comparison(dataclasses.asdict(run.read(Comparison))), run.case.flow
        return filter_of_mat(run.read(Mat), run.case.flow.flow()), run.case.flow
    case = read_case(source)
    return filter_of_mat(generate(case.mat, mat_predictor(case)), case.flow.flow()), case.flow
