"""What there is to draw of a run."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.line.results import Results
from pipeline.nouns.arrays import Floats
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import QualityReport
from pipeline.nouns.surface import Surface
from pipeline.report.views.scenes import Subject


def subject_of(content: Results) -> Subject | None:
    """Give what there is to draw; None before there is a mat."""
    mat = content.get(Mat)
    if mat is None:
        return None
    surface, domain, mesh = content.get(Surface), content.get(FluidDomain), content.get(FaceMesh)
    trouble = places_of_trouble(content.get(QualityReport))
    return Subject(mat, surface, domain, mesh, trouble, content.get(FlowField))


def places_of_trouble(report: QualityReport | None) -> Floats | None:
    """Where the worst cells and faces beyond a limit are, (n, 3) array [m]; None where there are none."""
    if report is None:
        return None
    places = [place for metric in report.metrics.values() for _, _, place in metric.worst[: metric.over_limit]]
    return np.array(places) if places else None
