"""`fibertwin measure` and `fibertwin micrograph`: from a picture to its fibers' laws, and from a mat to its picture."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import os
import sys
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError
from rich.console import Console

from pipeline.cli.tables import plain_table
from pipeline.errors import CaseError
from pipeline.line.places import disk_trouble_explained
from pipeline.micrograph.case import case_of
from pipeline.micrograph.measure import Interval, Measured, measure
from pipeline.micrograph.page import facts, write_page
from pipeline.microscope.picture import Micrograph
from pipeline.microscope.read import Window, read_micrograph
from pipeline.units import FROM_FILE, Length
from pipeline.writing import write_whole


def measure_picture(
    path: Path,
    pixel: str | None,
    bar: str | None,
    window: str | None,
    page: Path | None,
    case: Path | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Measure a picture, print what was seen, and write its page and its case."""
    picture = read_micrograph(path, read_length(pixel, "--pixel"), read_length(bar, "--bar"), _window(window))
    if case is not None and os.path.lexists(case):
        raise CaseError(f"{case} is there already; name another file for the case")
    measured = measure(picture)
    if case is not None:
        with disk_trouble_explained(case):
            text = case_of(measured, picture.origin, path_beside(path, case), picture.pixel)
            write_whole(case, text)
    page = page or Path("runs") / path.stem / "micrograph.html"
    with disk_trouble_explained(page):
        write_page(picture, measured, page)
    if as_json:
        sys.stdout.write(json.dumps(_as_json(path, picture, measured), indent=2, allow_nan=False) + "\n")
        return
    if quiet:
        return
    out = Console()
    out.print(plain_table("fibers of the picture", ("", ""), facts(picture, measured)))
    for note in measured.warnings:
        out.print(f"- {note}", markup=False, highlight=False, soft_wrap=True)
    for what, file in (("look at it:", page), ("run it: fibertwin run", case)):
        if file is not None:
            out.print(what, file, markup=False, highlight=False, soft_wrap=True)


def path_beside(picture: Path, case: Path | None) -> str:
    """Give the path of a picture from the folder of a case file, or from here where that has no place."""
    return Path(os.path.relpath(picture, case.parent if case is not None else Path())).as_posix()


def read_length(text: str | None, option: str) -> float | None:
    """Read a length with its unit that an option was given [m]."""
    if text is None:
        return None
    try:
        return float(TypeAdapter[Any](Length).validate_python(text, context=FROM_FILE))
    except ValidationError as problem:
        reason = problem.errors()[0]["msg"].removeprefix("Value error, ")
        raise CaseError(f"{option} {text!r}: {reason[:1].lower()}{reason[1:]}") from None


def _window(text: str | None) -> Window | None:
    if text is None:
        return None
    try:
        left, top, right, bottom = (int(part) for part in text.split(","))
    except ValueError:
        raise CaseError(f"--window {text!r}: write left,top,right,bottom in pixels, as 0,0,1024,768") from None
    return left, top, right, bottom


def _as_json(path: Path, picture: Micrograph, measured: Measured) -> dict[str, Any]:
    """Give what was measured in SI: meters, and degrees for directions."""

    def bounds(interval: Interval) -> list[float]:
        return [interval.low, interval.high]

    order = measured.orientation
    return {
        "fibers": measured.fibers,
        "diameter": {
            "mean": measured.mean.value,
            "std": measured.std.value,
            "median": measured.median.value,
            "mean_interval": bounds(measured.mean),
            "std_interval": bounds(measured.std),
            "median_interval": bounds(measured.median),
            "length_weighted": {"mean": measured.length_mean, "std": measured.length_std},
            "laws": [{"name": law.name, "aic": law.aic, **law.parameters} for law in measured.laws],
            "values": measured.diameter.tolist(),
        },
        "orientation": {
            "law": order.law,
            "axis": order.axis,
            "concentration": order.concentration,
            "order": order.order,
        },
        "coverage": measured.coverage,
        "ends": measured.ends,
        "picture": str(path),
        "pixel": picture.pixel,
        "blur": measured.blur,
        "streaks": measured.streaks,
        "warnings": list(measured.warnings),
    }


def take_picture(
    source: Path, into: Path, pixel: str | None, depth: str | None, edge: float, blur: float, noise: float, seed: int
) -> None:
    """Write the micrograph that a case's or a run's mat would give."""
    from pipeline.microscope.synthetic import Exposure, micrograph_of
    from pipeline.microscope.write import write_png

    mat = _mat_of(source)
    length = read_length(pixel, "--pixel") or 2.0 * float(mat.radius.mean()) / 20.0
    shade = read_length(depth, "--depth") or 6.0 * float(mat.radius.mean())
    picture = micrograph_of(mat, length, Exposure(shade, edge, blur, noise, seed))
    if into.suffix.lower() != ".png":
        raise CaseError(f"{into}: a micrograph is written as .png")
    with disk_trouble_explained(into):
        into.parent.mkdir(parents=True, exist_ok=True)
        write_png(picture, into)


def _mat_of(source: Path) -> Any:
    from pipeline.case import read_case
    from pipeline.line.run import Run
    from pipeline.mat.generate import generate
    from pipeline.mat.make import mat_predictor
    from pipeline.nouns.fibers import Mat

    if source.is_dir():
        return Run.opened(source).read(Mat)
    case = read_case(source)
    return generate(case.mat, mat_predictor(case))
