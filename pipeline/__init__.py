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
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from pipeline.machine_code import make_room

if TYPE_CHECKING:
    from pipeline.analytics import compare as compare
    from pipeline.analytics import predict as predict
    from pipeline.case import Case as Case
    from pipeline.case import read_case as read_case
    from pipeline.enclosure.duct import enclose as enclose
    from pipeline.export import read_mesh as read_mesh
    from pipeline.mat import generate as generate
    from pipeline.mat import measure as measure
    from pipeline.quality import judge as judge
    from pipeline.run import Run as Run
    from pipeline.run import run as run
    from pipeline.surface.union import unite as unite
    from pipeline.tetmesh.fill import fill as fill

_HOMES = {
    "Case": "pipeline.case",
    "Run": "pipeline.run",
    "compare": "pipeline.analytics",
    "enclose": "pipeline.enclosure.duct",
    "fill": "pipeline.tetmesh.fill",
    "generate": "pipeline.mat",
    "judge": "pipeline.quality",
    "measure": "pipeline.mat",
    "predict": "pipeline.analytics",
    "read_case": "pipeline.case",
    "read_mesh": "pipeline.export",
    "run": "pipeline.run",
    "unite": "pipeline.surface.union",
}
__all__ = ["Case", "Run", "compare", "enclose", "fill", "generate", "judge", "measure", "predict", "read_case"]
__all__ += ["read_mesh", "run", "unite"]


class _Package(ModuleType):
    # The import system puts the submodule `run` here once somebody loads it: `from pipeline import run` would be a
    # function or a module, depending on what was imported before. It is the function, always.
    @property
    def run(self) -> Any:
        return sys.modules["pipeline.run"].run if "pipeline.run" in sys.modules else __getattr__("run")

    @run.setter
    def run(self, module: ModuleType) -> None:
        pass


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})


sys.modules[__name__].__class__ = _Package

make_room()
