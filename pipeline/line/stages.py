"""The stages of the line, in order: one line each. What a stage is stands in its own room."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.analytics.settings import FlowSettings
from pipeline.capture.stage import CAPTURE
from pipeline.compare.stage import COMPARE
from pipeline.enclosure.stage import ENCLOSURE
from pipeline.export.stage import EXPORT
from pipeline.line.stage import Stage
from pipeline.mat.stage import MAT
from pipeline.mesh.stage import TETMESH
from pipeline.microscope.stage import MICROGRAPH
from pipeline.quality.stage import QUALITY
from pipeline.report.stage import REPORT
from pipeline.solve.stage import SOLVE
from pipeline.structure.stage import STRUCTURE
from pipeline.surface.stage import SURFACE

LINE: tuple[Stage, ...] = (
    MAT,
    MICROGRAPH,
    SURFACE,
    STRUCTURE,
    ENCLOSURE,
    TETMESH,
    QUALITY,
    EXPORT,
    COMPARE,
    SOLVE,
    CAPTURE,
    REPORT,
)

SHARED = {"flow": (FlowSettings, "The air: its velocity and its properties.")}
"""Tables of the case file that no single stage owns: their settings, and what they are about."""
