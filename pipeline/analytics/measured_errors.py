"""What is known of a pressure drop's error before other meshes are solved: measured once on mats, and kept in a file.

``docs/verify.py`` writes the file beside this one; docs/verification.md shows it and says how it was measured.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import math
import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

FILE = Path(__file__).with_suffix(".json")
_USUAL = 0.6  # default edge, whose growth is 1
_SAME = 0.02
_LEAST_ORDER = 1.0  # an error that falls more slowly with the edge is none of the mesh's alone, and has no trend


@dataclass(frozen=True, slots=True)
class EdgeError:
    """How far pressure drops on meshes of one edge are off those on much finer ones.

    Parameters
    ----------
    mesher, solver : str
        As ``tetmesh.engine`` and ``solve.engine`` name them.
    edge : float [-]
        At the fibers, in fiber diameters.
    growth : float [-]
        How much longer edges become per distance from the fibers.
    mats : int
        How many were measured.
    mean, low, high : float [-]
        Of the error, relative: over the mats.
    cells : float
        Per fiber diameter of fiber length, on average.
    seconds : float [s]
        Of processor time for mesh and flow per fiber diameter of fiber length, the median.
    """

    mesher: str
    solver: str
    edge: float
    growth: float
    mats: int
    mean: float
    low: float
    high: float
    cells: float
    seconds: float


@dataclass(frozen=True, slots=True)
class SeedSpread:
    """How much mats of other seeds differ.

    Parameters
    ----------
    area : float [-]
        Plan of the mats in squared fiber diameters.
    mats : int
    deviation : float [-]
        Standard deviation of the pressure drop over its mean.
    """

    area: float
    mats: int
    deviation: float


@dataclass(frozen=True, slots=True)
class Measured:
    """All that the file holds.

    Parameters
    ----------
    source : str
        Where it is shown.
    edges : tuple of EdgeError
    seeds : SeedSpread
    """

    source: str
    edges: tuple[EdgeError, ...]
    seeds: SeedSpread


@cache
def measured() -> Measured:
    """Read the file."""
    content = json.loads(FILE.read_text(encoding="utf-8"))
    edges = tuple(EdgeError(**each) for each in content["edges"])
    return Measured(content["source"], edges, SeedSpread(**content["seeds"]))


def write_measured(found: Measured) -> None:
    """Write the file, numbers with four digits."""
    rounded = json.loads(json.dumps(asdict(found)), parse_float=lambda text: float(f"{float(text):.4g}"))
    FILE.write_text(json.dumps(rounded, indent=1) + "\n", encoding="utf-8")


def mesh_error(
    mesher: str, solver: str, edge: float, growth: float = 1.0, known: Sequence[EdgeError] | None = None
) -> EdgeError | None:
    """Interpolate what a mesh leaves; None outside the edges that several mats were measured at, or for another growth.

    Parameters
    ----------
    mesher, solver : str
        As ``tetmesh.engine`` and ``solve.engine`` name them.
    edge : float [-]
        At the fibers, in fiber diameters.
    growth : float [-]
        How much longer edges become per distance from the fibers.
    known : sequence of EdgeError
        Measured; those of the file unless given.

    Returns
    -------
    EdgeError or None
        Between the two measured edges around it, linear in the square of the edge.

    Examples
    --------
    >>> coarse = EdgeError("tetwild", "stokes", 1.0, 1.0, 5, 0.03, 0.02, 0.04, 100.0, 0.2)
    >>> fine = EdgeError("tetwild", "stokes", 0.5, 1.0, 5, 0.006, 0.004, 0.01, 300.0, 0.5)
    >>> round(mesh_error("tetwild", "stokes", 0.75, known=[coarse, fine]).mean, 3)
    0.016
    """
    key = mesher, solver, growth
    rows = sorted(
        (
            each
            for each in known or measured().edges
            # one mat has no range: what its mesh left is no interval for another
            if (each.mesher, each.solver, each.growth) == key and each.mats > 1
        ),
        key=lambda each: each.edge,
    )
    for low, high in pairwise(rows):
        if low.edge <= edge <= high.edge:
            share = (edge**2 - low.edge**2) / (high.edge**2 - low.edge**2)
            between = {
                name: (1.0 - share) * getattr(low, name) + share * getattr(high, name)
                for name in ("mean", "low", "high", "cells", "seconds")
            }
            return EdgeError(mesher, solver, edge, growth, min(low.mats, high.mats), **between)
    return None


def seed_spread(area: float) -> float | None:
    """Estimate how much another seed changes the pressure drop, as a standard deviation over the mean.

    Parameters
    ----------
    area : float [-]
        Plan in squared fiber diameters.

    Returns
    -------
    float [-] or None
        The measured one times the root of the ratio of areas, as independent parts of a plan average; None where the
        area is more than ten times that of the measured mats, or less than half of it.
    """
    seeds = measured().seeds
    if not 0.5 <= area / seeds.area <= 10.0:
        return None
    return seeds.deviation * math.sqrt(seeds.area / area)


@dataclass(frozen=True, slots=True)
class Need:
    """A mesh that is fine enough.

    Parameters
    ----------
    error : float [-]
        That is asked for, relative.
    edge : float [-]
        At the fibers, in fiber diameters.
    cells, seconds : float [-], [s]
        Per fiber diameter of fiber length, as in `EdgeError`.
    growth : float [-]
        That goes with it: in proportion to the edge where such meshes were measured.
    measured : bool
        Whether the edge lies within those measured; if not, it follows their trend.
    """

    error: float
    edge: float
    cells: float
    seconds: float
    growth: float
    measured: bool


def needed_edge(mesher: str, solver: str, error: float, known: Sequence[EdgeError] | None = None) -> Need | None:
    """Estimate the edge that gives an error, by powers of the edge fitted to what was measured.

    For finite volumes, which see all cells, meshes whose growth falls with their edge are followed where they were
    measured.

    Parameters
    ----------
    mesher, solver : str
        As ``tetmesh.engine`` and ``solve.engine`` name them.
    error : float [-]
        Relative.
    known : sequence of EdgeError
        Measured; those of the file unless given.

    Returns
    -------
    Need or None
        The coarsest edge that was measured, at most. None where fewer than two edges were measured, or where none of
        them gave the error and it does not fall with them in first order.

    Examples
    --------
    >>> rows = [EdgeError("m", "s", h, 1.0, 5, -0.1 * h**2, 0.0, 0.0, h**-3, h**-3) for h in (1.0, 0.5)]
    >>> need = needed_edge("m", "s", 0.001, rows)
    >>> round(need.edge, 3), round(need.cells), need.measured
    (0.1, 1000, False)
    """
    rows = [each for each in known or measured().edges if (each.mesher, each.solver) == (mesher, solver)]
    graded = [each for each in rows if abs(each.growth / each.edge - 1.0 / _USUAL) < _SAME * each.growth]
    rows = graded if solver == "openfoam" and len(graded) > 1 else [each for each in rows if each.growth == 1.0]
    if len(rows) < 2:
        return None
    edges = [each.edge for each in rows]
    (scale, power), cells, seconds = (
        _power(edges, values)
        for values in ([abs(r.mean) for r in rows], [r.cells for r in rows], [r.seconds for r in rows])
    )
    if power < _LEAST_ORDER:
        enough = [each.edge for each in rows if abs(each.mean) <= error]
        if not enough:
            return None
        edge = max(enough)
    else:
        # what coarser meshes than those measured leave is nobody's to tell
        edge = min((error / scale) ** (1.0 / power), max(edges))
    at = [each[0] * edge ** each[1] for each in (cells, seconds)]
    growth = edge / _USUAL if rows == graded else 1.0
    return Need(error, edge, at[0], at[1], growth, min(edges) <= edge)


def _power(edges: Sequence[float], values: Sequence[float]) -> tuple[float, float]:
    """Scale and power of the line through values on logarithmic axes."""
    slope, offset = statistics.linear_regression([math.log(e) for e in edges], [math.log(v) for v in values])
    return math.exp(offset), slope
