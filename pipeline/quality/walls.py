"""Whether the walls of a mesh stand on its fibers: the part of a verdict that no shape of a cell tells."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace

import numpy as np

from pipeline.nouns.fidelity import Fidelity
from pipeline.nouns.quality import Metric, QualityReport


def with_walls(report: QualityReport, fidelity: Fidelity, deviation: float) -> QualityReport:
    """Let a report judge the fibers too.

    A mesh whose every cell is good may have lost half of its fibers: a fiber that is missing, or whose walls are
    farther off than allowed, makes it fail.

    Parameters
    ----------
    report : QualityReport
        Of the cells.
    fidelity : Fidelity
        How the walls stand, fiber by fiber.
    deviation : float [-]
        Distance within which 99 % of each fiber's walls have to stand, in its own diameters.

    Returns
    -------
    QualityReport
        With the metric ``wall_deviation``, one value per fiber.
    """
    faults = fidelity.faults(deviation)
    off = np.array([walls.typical_deviation for walls in fidelity.fibers if walls.area > 0.0])
    metrics = dict(report.metrics)
    if len(off):
        metrics["wall_deviation"] = Metric(
            name="wall_deviation",
            unit="1",
            where="fibers",
            min=float(off.min()),
            mean=float(off.mean()),
            p99=float(np.percentile(off, 99)),
            max=float(off.max()),
            limit=deviation,
            worst_is="largest",
            over_limit=int((off > deviation).sum()),
            worst=(),
            source="99 % of a fiber's walls are nearer to it than this, in its diameters (tetmesh.deviation)",
        )
    verdict = "fail" if faults else report.verdict
    fibers = len(fidelity.fibers)
    return replace(report, metrics=metrics, verdict=verdict, reasons=(*faults, *report.reasons), fibers=fibers)
