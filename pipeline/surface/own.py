"""A medium that comes as a surface: read, mended where that is safe, and refused with the places where it is not."""

# SPDX-License-Identifier: GPL-3.0-or-later

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.geometry.crossings import crossing_pairs
from pipeline.geometry.solids import unite_within
from pipeline.geometry.triangles import (
    area_vectors,
    connected_pieces,
    enclosed_volume,
    on_sides,
    signed_volumes,
    unmatched_edges,
)
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.surface import Surface
from pipeline.nouns.surface_file import SurfaceFile
from pipeline.progress import Progress, silent
from pipeline.surface.remesh import Mended, mended

SUFFIXES = (".stl", ".ply", ".obj", ".vtp")
_THINNEST, _THICKEST = 5e-9, 1e-3
"""Mean diameters [m] beyond which the unit is asked for again: no fiber of a filter is thinner or thicker."""
_LARGEST = 4_000_000
"""Triangles beyond which a surface is refused: it takes a kilobyte a triangle to unite and to mesh."""
_ON_SIDE = 1e-5
"""Of the size: what files of 32 bits leave of a plane."""


@dataclass(frozen=True, slots=True)
class BodyMeasures:
    """What a user's own surface is like.

    Parameters
    ----------
    triangles, points : int
    area : float [m2]
        Without the flat cuts on the sides.
    volume : float [m3]
    solidity : float [-]
    mean_diameter : float [m]
        Four times volume over area: of cylinders, the mean weighted by surface.
    thickness : float [m]
    components : int
    mended : str
        What was mended, in words.
    """

    triangles: int
    points: int
    area: float
    volume: float
    solidity: float
    mean_diameter: float
    thickness: float
    components: int
    mended: str


def read_body(source: SurfaceFile, progress: Progress = silent) -> tuple[Surface, BodyMeasures]:
    """Read a surface, mend it, and cut it flush with its plan.

    Parameters
    ----------
    source : SurfaceFile
    progress : Progress

    Returns
    -------
    Surface
        Of one "fiber" of the mean diameter, without pieces: nobody knows its axes. It lies with its lower end at
        z = 0 and its plan from (0, 0).
    BodyMeasures

    Raises
    ------
    CaseError
        If the file cannot be read, is open or cuts itself where that cannot be mended, or has a size that tells of
        another unit.
    """
    path = Path(source.path)
    progress(f"reading {path.name}")
    points, triangles = _read(path)
    if len(triangles) > _LARGEST:
        raise CaseError(
            f"{path} has {len(triangles):,} triangles, more than {_LARGEST:,}; decimate it, or take a smaller window"
        )
    progress(f"mending {len(triangles):,} triangles")
    sound = mended(points, triangles)
    _refuse_unsound(sound, path, source.unit)
    points = source.unit * (sound.points - sound.points.min(axis=0))
    _refuse_unit(points, sound.triangles, path)
    _refuse_shells_that_cut_themselves(points, sound.triangles, path)
    points, triangles, slab = _cut(points, sound.triangles, source.side, path)
    free = ~on_sides(points, triangles, slab.lower, slab.upper)
    area = float(np.linalg.norm(area_vectors(points, triangles)[free], axis=1).sum())
    volume = enclosed_volume(points, triangles)
    diameter = 4.0 * volume / area
    none = np.zeros((0, 3))
    surface = Surface(
        points,
        triangles,
        np.zeros(len(triangles), np.int64),
        np.array([0.5 * diameter]),
        slab,
        Pieces(none, none, np.zeros(0, np.int64), np.zeros((0, 2), bool)),
    )
    return surface, BodyMeasures(
        triangles=len(triangles),
        points=len(points),
        area=area,
        volume=volume,
        solidity=surface.solidity,
        mean_diameter=diameter,
        thickness=slab.size[2],
        components=int(connected_pieces(triangles).max()) + 1,
        mended=sound.done or "nothing",
    )


def _read(path: Path) -> tuple[Floats, Ints]:
    if path.suffix.lower() not in SUFFIXES:
        raise CaseError(f"{path}: a surface is read from {', '.join(SUFFIXES)}, not from {path.suffix or 'a file'}")
    if not path.is_file():
        raise CaseError(f"cannot read the surface {path}: there is no such file")
    # VTK reads all four; it complains to the terminal, and then gives nothing
    import pyvista as pv

    pv.vtk_verbosity("off")
    try:
        with warnings.catch_warnings():
            # a reader that fails only warns
            warnings.simplefilter("error", UserWarning)
            mesh = pv.read(path)
    except (OSError, ValueError, RuntimeError, UserWarning) as problem:
        reason = str(problem).partition("\n")[0]
        raise CaseError(f"{path} is damaged, or no {path.suffix[1:].upper()} file: {reason}") from problem
    if not isinstance(mesh, pv.PolyData) or mesh.n_cells == 0:
        raise CaseError(f"{path} holds no triangle: it is damaged, or not the surface of a solid")
    mesh = mesh.triangulate()
    points = np.asarray(mesh.points, np.float64)
    faces = np.asarray(mesh.faces, np.int64).reshape(-1, 4)[:, 1:] if mesh.n_cells else np.zeros((0, 3), np.int64)
    if len(faces) < 4 or not np.isfinite(points).all():
        raise CaseError(f"{path} holds {len(faces)} triangles, or points that are no numbers: it is damaged")
    return points, faces


def _refuse_unsound(sound: Mended, path: Path, unit: float) -> None:
    edges = unmatched_edges(sound.triangles)
    if edges == 0 and len(sound.triangles):
        return
    where = "; ".join(_place(place * unit) for place in sound.open_places[:3])
    raise CaseError(
        f"{path} is open: {edges} edges have a triangle on one side only, and holes of more than "
        f"{sound.largest_hole} edges are not closed by guessing{', first at ' + where if where else ''}; "
        "close it in the program that made it, up to the sides of its window"
    )


def _refuse_unit(points: Floats, triangles: Ints, path: Path) -> None:
    area = float(np.linalg.norm(area_vectors(points, triangles), axis=1).sum())
    diameter = 4.0 * abs(enclosed_volume(points, triangles)) / area
    if _THINNEST <= diameter <= _THICKEST:
        return
    size = " x ".join(f"{1e6 * length:.3g}" for length in np.ptp(points, axis=0))
    raise CaseError(
        f"{path} would be {size} um large, of fibers of {1e6 * diameter:.3g} um: is mat.unit right? "
        f"Fibers of {1e9 * _THINNEST:g} nm to {1e3 * _THICKEST:g} mm are taken"
    )


def _cut(points: Floats, triangles: Ints, side: float | None, path: Path) -> tuple[Floats, Ints, Box]:
    """Unite the parts, which mends what cuts each other, and cut them at the plan."""
    size = np.ptp(points, axis=0)
    diameter = 4.0 * abs(enclosed_volume(points, triangles)) / _total_area(points, triangles)
    low, high = np.zeros(2), size[:2].copy()
    if side is not None:
        if side > size[:2].min():
            raise CaseError(
                f"mat.side = {1e6 * side:.4g} um is larger than {path}, whose plan is "
                f"{1e6 * size[0]:.4g} x {1e6 * size[1]:.4g} um"
            )
        low = 0.5 * (size[:2] - side)
        high = low + side
    else:
        for axis in (0, 1):
            for bound, place, sign in ((low, 0.0, 1.0), (high, size[axis], -1.0)):
                # a flat cut is taken off with a hair of what is behind it; what ends before keeps a margin of air
                flush = _is_flush(points, triangles, axis, place, size)
                bound[axis] += sign * (1e-3 * diameter if flush else -0.5 * diameter)
    limits = Box((*low.tolist(), -0.1 * size[2]), (*high.tolist(), 1.1 * size[2]))
    piece = connected_pieces(triangles)
    volume = np.bincount(piece, weights=signed_volumes(points, triangles))
    bodies = []
    for k in range(int(piece.max()) + 1):
        if volume[k] > 0:
            used, index = np.unique(triangles[piece == k], return_inverse=True)
            bodies.append((points[used], index.reshape(-1, 3)))
    cut, faces, _ = unite_within(bodies, limits)
    if len(faces) == 0:
        raise CaseError(f"{path}: nothing of the surface lies within the plan")
    shift = np.array([low[0], low[1], cut[:, 2].min()])
    cut = cut - shift
    plan = high - low
    for axis in (0, 1):
        # what was exactly on a side is so after the shift
        cut[:, axis] = np.where(np.abs(cut[:, axis]) < 1e-9 * plan[axis], 0.0, cut[:, axis])
        cut[:, axis] = np.where(np.abs(cut[:, axis] - plan[axis]) < 1e-9 * plan[axis], plan[axis], cut[:, axis])
    return cut, faces, Box((0.0, 0.0, 0.0), (float(plan[0]), float(plan[1]), float(cut[:, 2].max())))


def _is_flush(points: Floats, triangles: Ints, axis: int, place: float, size: Floats) -> bool:
    on = np.abs(points[:, axis] - place) <= _ON_SIDE * float(size.max())
    return bool(on[triangles].all(axis=1).any())


def _total_area(points: Floats, triangles: Ints) -> float:
    return float(np.linalg.norm(area_vectors(points, triangles), axis=1).sum())


def _refuse_shells_that_cut_themselves(points: Floats, triangles: Ints, path: Path) -> None:
    """Refuse a shell that cuts itself; shells that cut each other are united."""
    piece = connected_pieces(triangles)
    pairs = crossing_pairs(points, triangles)
    own = pairs[piece[pairs[:, 0]] == piece[pairs[:, 1]]]
    if len(own):
        where = "; ".join(_place(place) for place in points[triangles[own[:3, 0]]].mean(axis=1))
        raise CaseError(
            f"{path} cuts itself: {len(own)} pairs of triangles of one and the same shell pass through each other, "
            f"first at {where} from its lower corner; mend it in the program that made it, or remesh it"
        )


def _place(place: Floats) -> str:
    return f"({', '.join(f'{1e6 * x:.4g}' for x in place)}) um"
