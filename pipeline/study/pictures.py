"""The mats of a study side by side: one of each combination."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.case import read_case
from pipeline.mat.generate import generate
from pipeline.mat.make import mat_predictor
from pipeline.pictures.panels import contact_sheet, write_png
from pipeline.study.settings import Study
from pipeline.study.tables import shown


def draw_points(study: Study, path: Path, left_out: frozenset[int] = frozenset()) -> None:
    """Draw the mat of each combination, with the first seed, into one PNG.

    Parameters
    ----------
    study : Study
        With a ``picture``.
    path : Path
    left_out : frozenset of int
        Combinations whose mat cannot be made; one at least must be left.
    """
    assert study.picture is not None
    mats, labels = [], []
    for number, point in enumerate(study.points()):
        if number in left_out:
            continue
        settings = study.settings(point)
        case = read_case(study.case, settings)
        if hasattr(case.mat, "seed"):
            case = read_case(study.case, (*settings, f"mat.seed={study.first_seed}"))
        # a mat is grown again in less time than it takes to draw it
        mats.append(generate(case.mat, mat_predictor(case)))
        labels.append(", ".join(f"{key} {shown(value)}" for key, value in point.items()))
    write_png(contact_sheet(mats, labels, study.picture), path)
