"""fibertwin: from a fiber mat to a CFD case one can trust.

The line and its stages, for programs and notebooks (docs/python.md). Importing the package loads nothing; a name loads
its module when it is first used.

Examples
--------
>>> from pipeline import Case
>>> case = Case.model_validate(
...     {"mat": {"generator": "array", "arrangement": "square", "solidity": "10 %", "fiber_diameter": "1 um"}}
... )
>>> case.mat.fiber_diameter
1e-06
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib
from typing import TYPE_CHECKING, Any

from pipeline.machine_code import make_room

if TYPE_CHECKING:
    from pipeline.analytics.models.comparison import compare as compare
    from pipeline.analytics.models.prediction import predict as predict
    from pipeline.case import Case as Case
    from pipeline.case import read_case as read_case
    from pipeline.enclosure.duct import enclose as enclose
    from pipeline.export.read import read_mesh as read_mesh
    from pipeline.line.run import Run as Run
    from pipeline.line.run import run as run
    from pipeline.mat.generate import generate as generate
    from pipeline.mat.measures import measure as measure
    from pipeline.mesh.fill import fill as fill
    from pipeline.nouns.comparison import Comparison as Comparison
    from pipeline.nouns.domain import FluidDomain as FluidDomain
    from pipeline.nouns.fibers import Mat as Mat
    from pipeline.nouns.flow import Solution as Solution
    from pipeline.nouns.flow_field import FlowField as FlowField
    from pipeline.nouns.mesh import FaceMesh as FaceMesh
    from pipeline.nouns.quality import QualityReport as QualityReport
    from pipeline.nouns.surface import Surface as Surface
    from pipeline.quality.judge import judge as judge
    from pipeline.surface.union import unite as unite

_HOMES = {
    "Comparison": "pipeline.nouns.comparison",
    "FaceMesh": "pipeline.nouns.mesh",
    "FlowField": "pipeline.nouns.flow_field",
    "FluidDomain": "pipeline.nouns.domain",
    "Mat": "pipeline.nouns.fibers",
    "QualityReport": "pipeline.nouns.quality",
    "Solution": "pipeline.nouns.flow",
    "Surface": "pipeline.nouns.surface",
    "Case": "pipeline.case",
    "Run": "pipeline.line.run",
    "compare": "pipeline.analytics.models.comparison",
    "enclose": "pipeline.enclosure.duct",
    "fill": "pipeline.mesh.fill",
    "generate": "pipeline.mat.generate",
    "judge": "pipeline.quality.judge",
    "measure": "pipeline.mat.measures",
    "predict": "pipeline.analytics.models.prediction",
    "read_case": "pipeline.case",
    "read_mesh": "pipeline.export.read",
    "run": "pipeline.line.run",
    "unite": "pipeline.surface.union",
}
__all__ = [
    "Case",
    "Comparison",
    "FaceMesh",
    "FlowField",
    "FluidDomain",
    "Mat",
    "QualityReport",
    "Run",
    "Solution",
    "Surface",
]
__all__ += [
    "compare",
    "enclose",
    "fill",
    "generate",
    "judge",
    "measure",
    "predict",
    "read_case",
    "read_mesh",
    "run",
    "unite",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})


make_room()
