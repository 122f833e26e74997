"""What a mesh is like."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.nouns.arrays import Floats, freeze, require


@dataclass(frozen=True, slots=True)
class Metric:
    """One measure of quality over a mesh.

    Parameters
    ----------
    name, unit, source : str
        Unit ``"1"`` where it has none; `source` says whose definition and limit these are.
    where : str
        ``"cells"``, ``"faces"``, ``"internal faces"`` or ``"fibers"``.
    min, mean, p99, max : float [unit]
        The mean non-orthogonality is the angle of the mean cosine, as `checkMesh` prints it.
    limit : float [unit], optional
        What a good mesh keeps to.
    worst_is : str
        ``"largest"`` or ``"smallest"``: on which side of the limit trouble lies.
    over_limit : int
        How many cells or faces break the limit.
    worst : tuple of (index, value, (x, y, z) [m])
        The worst few, worst first.
    """

    name: str
    unit: str
    where: str
    min: float
    mean: float
    p99: float
    max: float
    limit: float | None
    worst_is: str
    over_limit: int
    worst: tuple[tuple[int, float, tuple[float, float, float]], ...]
    source: str


@dataclass(frozen=True, slots=True)
class QualityReport:
    """What the mesh is like and whether it may go to a solver.

    `verdict` is ``"pass"`` where every limit holds; ``"warn"`` where what does not hold costs accuracy but stops no
    solver (non-orthogonality below 90 degrees, and what only ``checkMesh -allGeometry`` looks at: determinant, face
    weight, volume ratio, concave cells, tetrahedra at faces); ``"fail"`` where plain `checkMesh` fails too. `reasons`
    has a sentence for each limit that does not hold, `notes` one for what stops no solver but may not be meant: parts
    that do not touch, patches without a face. `patches` counts faces, `volume` is in m3. `fibers` counts the fibers
    whose walls were held against them; 0 where nobody knows of fibers, and the verdict is of the cells alone.
    """

    cells: int
    points: int
    faces: int
    internal_faces: int
    patches: dict[str, int]
    volume: float
    metrics: dict[str, Metric]
    verdict: str
    reasons: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    fibers: int = 0

    @property
    def passed(self) -> bool:
        """Whether every limit holds."""
        return self.verdict == "pass"


@dataclass(frozen=True, eq=False, slots=True)
class CellFields:
    """Measures of quality as fields on the cells, for coloring them.

    Parameters
    ----------
    names : tuple of str
    values : (names, cells) array
    """

    names: tuple[str, ...]
    values: Floats

    def __post_init__(self) -> None:
        freeze(self, values=np.asarray(self.values, np.float64))
        require(self.values.ndim == 2 and len(self.values) == len(self.names), "not every name has its values")

    def by_name(self) -> dict[str, Floats]:
        """Give each field by its name, (cells,) arrays."""
        return dict(zip(self.names, self.values, strict=True))
