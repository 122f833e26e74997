"""From the air's closed surface to tetrahedra: scale, run fTetWild, find the patches, mend, check."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import psutil

from pipeline.data import FIBERS, Floats, FluidDomain, Ints, TetMesh
from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.geometry.tets import boundary, volumes
from pipeline.geometry.triangles import area_vectors
from pipeline.progress import Progress, silent
from pipeline.tetmesh.child import Limits, Meshed, run_child
from pipeline.tetmesh.corners import split_corners, split_longest
from pipeline.tetmesh.crevices import in_crevice, largest_part
from pipeline.tetmesh.fit import fitted
from pipeline.tetmesh.patches import assign, flattened, planes
from pipeline.tetmesh.settings import TetmeshSettings
from pipeline.tetmesh.size_field import size_field

_SWEEPS = 20  # of mending; the last of them move next to nothing
_FITS = 2  # the second makes good what mending after the first moved
_FILLINGS = 8  # rounds of mending and filling crevices
_PATIENCE = 3  # rounds before cells that cannot be mended are filled though a vertex of theirs could move
_WALL_LEASH = 0.5  # envelopes that mending may move a vertex of a fiber
_ATTEMPTS = 3  # of the mesher at keeping the duct's planes; its randomness differs each time
_PLANE_ERROR = 0.01  # of a plane's area; rounding of the fibers' cuts takes a few thousandths
_MEMORY_SHARE = 0.85  # of the machine's memory, where the case names no limit


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


def tetrahedralize(
    domain: FluidDomain, settings: TetmeshSettings, tell: Progress = silent
) -> tuple[TetMesh, TetmeshMeasures]:
    """Fill the air with tetrahedra.

    The mesh differs a little from run to run: fTetWild draws from the system's own randomness.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    tell : Progress

    Returns
    -------
    TetMesh, TetmeshMeasures

    Raises
    ------
    StageError
        If the mesher fails, loses part of a plane, or the fibers' volume is further off than the settings allow.
    """
    # fTetWild compares an area with 1e-8 of a length: only geometry of order one survives that
    unit = 2.0 * float(domain.radius.mean())
    middle = 0.5 * (np.array(domain.box.lower) + np.array(domain.box.upper))
    raw, points, tets = _meshed(domain, settings, unit, middle, tell)
    raw_error = _volume_error(raw.points * unit + middle, raw.tets, domain)

    tell("mending the worst cells")
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


def _meshed(
    domain: FluidDomain, settings: TetmeshSettings, unit: float, middle: Floats, tell: Progress
) -> tuple[Meshed, Floats, Ints]:
    """Run the mesher until it keeps the duct's planes; give what it left, and points and cells with flat planes."""
    for _ in range(_ATTEMPTS):
        raw = _run((domain.points - middle) / unit, domain, settings, tell)
        tell("finding the patches")
        points, tets = _used(raw.points * unit + middle, raw.tets)
        faces, _ = boundary(tets)
        # two envelopes: the mesher bounds the distance to the surface, not the distance along the plane's normal
        patch = assign(points, faces, domain.box, tolerance=2.0 * settings.envelope * unit)
        points = flattened(points, faces, patch, domain.box)
        tets = _without_flat_sides(points, tets, domain.box)
        # fTetWild may leave triangles of its input out, by chance: a dent in a plane then counts as fiber, which the
        # fibers' volume, fitted afterwards, does not show, and which raised a drag by half
        errors = _plane_errors(points, tets, domain)
        worst = max(errors, key=lambda name: abs(errors[name]))
        if abs(errors[worst]) <= _PLANE_ERROR:
            return raw, points, tets
        tell(f"the mesher lost part of {worst}: meshing again")
    raise StageError(
        f"the mesher lost part of the patch {worst} {_ATTEMPTS} times, whose area is off by {errors[worst]:+.2%} "
        f"(allowed: {_PLANE_ERROR:.0%}); raise tetmesh.passes (now {settings.passes}) or tetmesh.envelope, or lower "
        "surface.sides"
    )


def _plane_errors(points: Floats, tets: Ints, domain: FluidDomain) -> dict[str, float]:
    """Relative error of the area of each plane of the duct."""
    faces, _ = boundary(tets)
    patch = assign(points, faces, domain.box, tolerance=0.0)
    return {
        name: _area(points, faces[patch == number]) / _area(domain.points, domain.triangles[domain.patch == number])
        - 1.0
        for number, name in enumerate(domain.patches)
        if name != FIBERS
    }


def _area(points: Floats, faces: Ints) -> float:
    return float(np.linalg.norm(area_vectors(points, faces), axis=1).sum())


def _run(points: Floats, domain: FluidDomain, settings: TetmeshSettings, tell: Progress) -> Meshed:
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    on_fibers = np.unique(domain.triangles[domain.patch == domain.patches.index(FIBERS)])
    sizes = size_field(
        points.min(axis=0), points.max(axis=0), points[on_fibers], settings.edge, settings.growth, settings.largest_edge
    )
    options = {
        # the field can only shorten the mesher's own edge length
        "edge_length_abs": float(sizes["bg_values"].max()),
        # relative to the diagonal there, to the fiber here: a longer plenum must not loosen the fibers
        "epsilon": settings.envelope / diagonal,
        "stop_energy": settings.stop_energy,
        "num_opt_iter": settings.passes,
        "num_threads": 1,  # a second one saves a tenth of the time
        "vtk_ordering": True,  # else every volume is negative
        "quiet": False,  # the log is what progress is read from
        "loglevel": 3,
    }
    memory = settings.memory_limit or _MEMORY_SHARE * psutil.virtual_memory().total
    return run_child(points, domain.triangles, options, sizes, Limits(settings.time_limit, memory), tell)


def _used(points: Floats, tets: Ints) -> tuple[Floats, Ints]:
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
    points, tets = _used(*best[:2])
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


def _without_flat_sides(points: Floats, tets: Ints, box: Box) -> Ints:
    # a sliver whose four vertices were all within the envelope of one plane is now flat on it: without it the
    # boundary is the same plane
    flat = np.zeros(len(tets), dtype=bool)
    for plane in planes(box):
        flat |= (points[tets, plane.axis] == plane.value).all(axis=1)
    return tets[~flat]


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
