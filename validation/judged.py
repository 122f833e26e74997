"""What three meshes of one array or lattice tell, with the exact value and without it."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from pipeline.study.convergence import Convergence, convergence

MESHES = 3


class Measured(Protocol):
    """An answer on one mesh whose exact value is known."""

    @property
    def spacing(self) -> float:
        """(Air volume / cells)^(1/3), in any unit."""

    @property
    def error(self) -> float:
        """Of the resistance, relative."""


Answer = TypeVar("Answer", bound=Measured)


@dataclass(frozen=True, slots=True)
class Judged(Generic[Answer]):
    """What three meshes tell.

    Parameters
    ----------
    rungs : list of 3
        Coarse to fine.
    order : float [-]
        In which power of the spacing the error against the exact value fell from the coarse to the fine mesh; nan
        where one of them is 0.
    found : Convergence or None
        What the three tell without the exact value; its extrapolation is of the resistance over the exact one. None
        where their spacings do not fall, as where an octree halves its cubes in gaps on one edge and not on the next.
    """

    rungs: list[Answer]
    order: float
    found: Convergence | None

    @property
    def fine(self) -> Answer:
        """The answer on the finest mesh."""
        return self.rungs[-1]


def judged(rungs: Sequence[Answer]) -> list[Judged[Answer]]:
    """Judge each three meshes, coarse to fine, of one array or lattice."""
    results = []
    for start in range(0, len(rungs), MESHES):
        coarse, middle, fine = three = list(rungs[start : start + MESHES])
        spacings = coarse.spacing, middle.spacing, fine.spacing
        answers = 1.0 + coarse.error, 1.0 + middle.error, 1.0 + fine.error
        found = convergence(spacings, answers) if spacings[0] > spacings[1] > spacings[2] else None
        fall = abs(coarse.error / fine.error) if coarse.error and fine.error else math.nan
        results.append(Judged(three, math.log(fall) / math.log(coarse.spacing / fine.spacing), found))
    return results
