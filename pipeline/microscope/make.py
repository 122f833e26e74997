"""Take the picture of the mat, and cut it and the measured one to the same size."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.line import store
from pipeline.microscope.picture import Micrograph
from pipeline.microscope.read import read_micrograph
from pipeline.microscope.synthetic import Exposure, micrograph_of
from pipeline.microscope.write import write_png
from pipeline.nouns.fibers import Mat
from pipeline.nouns.micrographs import Micrographs
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts

TWIN, MEASURED = "twin.png", "measured.png"


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Take the pictures."""
    settings, mat = results.case.micrograph, results.read(Mat)
    diameter = 2.0 * float(mat.radius.mean())
    measured = None if settings.file is None else read_micrograph(settings.file, settings.pixel)
    pixel = measured.pixel if measured is not None else settings.pixel or diameter / 20.0
    exposure = Exposure(settings.depth or 3.0 * diameter, settings.edge, settings.blur, settings.noise, settings.seed)
    twin = micrograph_of(mat, pixel, exposure)
    if measured is not None:
        rows, columns = (
            min(one, other) for one, other in zip(twin.brightness.shape, measured.brightness.shape, strict=True)
        )
        twin, measured = middle(twin, rows, columns), middle(measured, rows, columns)
        write_png(measured, into / MEASURED)
    write_png(twin, into / TWIN)
    width, height = twin.size
    pictures = Micrographs(TWIN, None if measured is None else MEASURED, pixel, width, height)
    store.write_json(into / "micrographs.json", pictures)
    return {"pixel": pixel, "width": width, "height": height}


def middle(picture: Micrograph, rows: int, columns: int) -> Micrograph:
    """Cut so many rows and columns out of the middle of a picture."""
    top, left = ((have - take) // 2 for have, take in zip(picture.brightness.shape, (rows, columns), strict=True))
    return Micrograph(picture.brightness[top : top + rows, left : left + columns], picture.pixel, picture.origin)


def obstacle(results: "Results") -> str | None:
    """Say why there is no picture: a medium that is there as a surface has no fibers."""
    if results.case.mat.generator == "surface":
        return "a medium that is there as a surface has no fibers to take a picture of"
    return None
