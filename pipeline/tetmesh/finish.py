"""Make a mesh fit for a solver: mend its worst cells, fill its crevices, give the fibers their volume, check."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.data import FIBERS, Floats, FluidDomain, Ints, TetMesh
from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.geometry.tets import boundary, volumes
from pipeline.progress import Progress
from pipeline.tetmesh.corners import split_corners, split_longest
from pipeline.tetmesh.crevices import in_crevice, largest_part
from pipeline.tetmesh.fit import fitted
from pipeline.tetmesh.patches import assign, planes
from pipeline.tetmesh.raw import RawMesh
from pipeline.tetmesh.settings import TetmeshSettings

_SWEEPS = 20  # of mending; the last of them move next to nothing
_FITS = 2  # the second makes good what mending after the first moved
_FILLINGS = 8  # rounds of mending and filling crevices
_PATIENCE = 3  # rounds before cells that cannot be mended are filled though a vertex of theirs could move
_WALL_LEASH = 0.5  # envelopes that mending may move a vertex of a fiber


@dataclass(frozen=True, slots=True)
class TetmeshMeasures:
    """What the mesher made of the fibers.

    Parameters
    ----------
    points, cells : int
    fluid_volume : float [m3]
    volume_error : float [-]
        Solid volume in the duct, mesh against surface, relative.
    raw_volume_error : float [-]
        The same as fTetWild left it, before the fibers' vertices were moved.
    filled_volume : float [-]
        Share of the air, in the tips of crevices, that was given to the fibers.
    faulty_cells : int
        Cells still beyond what mending aims at, a little inside the usual limits.
    mesher_seconds : float [s]
    mesher_peak_memory : int [byte]
    """

    points: int
    cells: int
    fluid_volume: float
    volume_error: float
    raw_volume_error: float
    filled_volume: float
    faulty_cells: int
    mesher_seconds: float
    mesher_peak_memory: int


def finished(
    raw: RawMesh, domain: FluidDomain, settings: TetmeshSettings, unit: float, tell: Progress
) -> tuple[TetMesh, TetmeshMeasures]:
    """Mend what an engine left, restore the fibers' volume, and check both.

    Parameters
    ----------
    raw : RawMesh
    domain : FluidDomain
    settings : TetmeshSettings
    unit : float [m]
        Mean fiber diameter.
    tell : Progress

    Returns
    -------
    TetMesh, TetmeshMeasures

    Raises
    ------
    StageError
        If cells without volume remain, or the fibers' volume is further off than the settings allow.
    """
    points, tets = used_points(raw.points, raw.tets)
    raw_error = _volume_error(points, tets, domain)
    tell("mending the worst cells", 0.6)
    filled = 0.0
    for _ in range(_FITS):
        points, tets, faulty, tips = _settled(points, tets, domain, _WALL_LEASH * settings.envelope * unit)
        filled += tips
        walls = _walls(points, tets, domain)
        points = fitted(points, tets, walls, _free_axes(points, domain.box), domain.volume)
    _check_volumes(points, tets)

    faces, _ = boundary(tets)
    mesh = TetMesh(points, tets, faces, assign(points, faces, domain.box, tolerance=0.0), domain.patches, domain.slab)
    measures = TetmeshMeasures(
        points=len(points),
        cells=len(tets),
        fluid_volume=mesh.volume,
        volume_error=_volume_error(points, tets, domain),
        raw_volume_error=raw_error,
        filled_volume=filled / domain.volume,
        faulty_cells=faulty,
        mesher_seconds=raw.seconds,
        mesher_peak_memory=raw.peak_memory,
    )
    if abs(measures.volume_error) > settings.volume_error:
        raise StageError(
            f"the mesh keeps the fibers' volume to {measures.volume_error:+.2%}, allowed is "
            f"{settings.volume_error:.2%}; lower tetmesh.envelope (now {settings.envelope:g} diameters) "
            "or raise tetmesh.volume_error"
        )
    return mesh, measures


def used_points(points: Floats, tets: Ints) -> tuple[Floats, Ints]:
    """Drop the points that no tetrahedron uses: points (k, 3), and the tets (m, 4) by their new numbers."""
    used, renumbered = np.unique(tets, return_inverse=True)
    return points[used], renumbered.reshape(-1, 4)


def _walls(points: Floats, tets: Ints, domain: FluidDomain) -> Ints:
    faces, _ = boundary(tets)
    walls: Ints = faces[assign(points, faces, domain.box, tolerance=0.0) == domain.patches.index(FIBERS)]
    return walls


def _settled(points: Floats, tets: Ints, domain: FluidDomain, wall_leash: float) -> tuple[Floats, Ints, int, float]:
    """Mend, fill the crevices where mending cannot help, and so on; give the state with the fewest faulty cells."""
    filled, fewest = 0.0, len(tets) + 1
    best = (points, tets, fewest, filled)
    for filling in range(_FILLINGS):
        tets = tets[largest_part(tets)]
        points, tets = split_corners(points, tets)
        points, faulty = _mended(points, tets, domain, wall_leash)
        # a flat cell is worse than any number of merely bad ones
        count = int(faulty.sum()) + len(tets) * int((volumes(points, tets) <= 0.0).sum())
        if count < best[2]:
            best = (points, tets, count, filled)
        if not faulty.any():
            break
        stuck = filling >= _PATIENCE
        # away from the fibers nothing is a crevice: a filled cell at the inlet of a coarse mesh doubled a pressure drop
        crevice = in_crevice(tets, len(points), faulty, stuck)
        crevice &= _at_fibers(points, tets, domain)
        filled += float(volumes(points, tets[crevice]).sum())
        tets, faulty = tets[~crevice], faulty[~crevice]
        if stuck and faulty.any():
            points, tets = split_longest(points, tets, faulty)
    points, tets = used_points(*best[:2])
    return points, tets, best[2], best[3]


def _at_fibers(points: Floats, tets: Ints, domain: FluidDomain) -> npt.NDArray[np.bool_]:
    on_fibers = np.zeros(len(points), dtype=bool)
    on_fibers[_walls(points, tets, domain)] = True
    return np.asarray(on_fibers[tets].any(axis=1))


def _mended(points: Floats, tets: Ints, domain: FluidDomain, wall_leash: float) -> tuple[Floats, npt.NDArray[np.bool_]]:
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.tetmesh.mend import mended

    leash = np.full(len(points), np.inf)
    leash[_walls(points, tets, domain)] = wall_leash
    return mended(points, tets, _free_axes(points, domain.box), leash, _SWEEPS)


def _volume_error(points: Floats, tets: Ints, domain: FluidDomain) -> float:
    solid = domain.box.volume - domain.volume
    return float((domain.volume - volumes(points, tets).sum()) / solid)


def _free_axes(points: Floats, box: Box) -> Floats:
    free = np.ones_like(points)
    for plane in planes(box):
        free[points[:, plane.axis] == plane.value, plane.axis] = 0.0
    return free


def _check_volumes(points: Floats, tets: Ints) -> None:
    flat = np.flatnonzero(volumes(points, tets) <= 0.0)
    if len(flat):
        place = points[tets[flat[0]]].mean(axis=0) * 1e6
        raise StageError(
            f"{len(flat)} of {len(tets)} tetrahedra have no volume, first at ({place[0]:.3g}, {place[1]:.3g}, "
            f"{place[2]:.3g}) um; lower tetmesh.edge or tetmesh.envelope"
        )
