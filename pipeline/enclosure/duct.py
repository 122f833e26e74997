"""Box minus fibers is the air; every triangle of its surface gets its patch."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from pipeline.enclosure.settings import EnclosureSettings
from pipeline.errors import CaseError, StageError
from pipeline.geometry.box import Box
from pipeline.geometry.solids import box_minus
from pipeline.geometry.triangles import Floats, Ints, connected_pieces, signed_volumes, winding_number
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.patches import DUCT, FIBERS, INLET, OUTLET, PATCHES
from pipeline.nouns.surface import Surface
from pipeline.progress import Progress, silent

_PLANES = [name for _, _, name in sorted((each.axis, each.end, each.name) for each in DUCT if each.axis is not None)]
"""Patches in the order of a box's planes: lower and upper along x, y, z."""

CLEARANCE = 0.1
"""Least distance between fibers and a plenum's end, in mean fiber diameters: the mesher's envelope is half of it."""


def fiber_spacing(surface: Surface) -> float:
    r"""Distance between neighbors in a square array of the same solidity and fiber cross-section.

    .. math:: s = \sqrt{\pi \overline{r^2} / \alpha}

    Parameters
    ----------
    surface : Surface

    Returns
    -------
    float [m]
    """
    return math.sqrt(math.pi * float(np.mean(surface.radius**2)) / surface.solidity)


def duct(surface: Surface, settings: EnclosureSettings) -> Box:
    """Give the slab with both plenums.

    A disturbance of period s dies out upstream and downstream as exp(-2 pi z / s): three spacings leave
    1e-8 of it, and pores several times as wide as the mean still settle.

    Parameters
    ----------
    surface : Surface
    settings : EnclosureSettings

    Returns
    -------
    Box [m]

    Raises
    ------
    StageError
        If fibers stick out of the slab so far that they touch the end of a plenum.
    """
    usual = 3.0 * fiber_spacing(surface)
    box = surface.slab.extended(settings.inlet or usual, settings.outlet or usual)
    needed = CLEARANCE * 2.0 * float(surface.radius.mean())
    low, high = float(surface.points[:, 2].min()), float(surface.points[:, 2].max())
    for name, gap, beyond in (
        (INLET, low - box.lower[2], surface.slab.lower[2] - low),
        (OUTLET, box.upper[2] - high, high - surface.slab.upper[2]),
    ):
        if gap < needed:
            raise StageError(
                f"the mat touches the end of the {name} plenum: fibers reach {max(beyond, 0.0):.3g} m out of the slab "
                f"there; make enclosure.{name} at least {max(beyond, 0.0) + needed:.3g} m"
            )
    return box


def enclose(surface: Surface, settings: EnclosureSettings, progress: Progress = silent) -> FluidDomain:
    """Cut the fibers out of a duct and name every triangle's patch.

    Air that reaches neither inlet nor outlet (pockets closed in between fibers that touch) does not flow and is
    left out; it then counts as solid.

    Parameters
    ----------
    surface : Surface
    settings : EnclosureSettings
    progress : Progress

    Returns
    -------
    FluidDomain

    Raises
    ------
    CaseError
        If the sides are to be cyclic and opposite ones do not fit each other.
    StageError
        If fibers touch the end of a plenum or close the duct, or the difference fails.
    """
    box = duct(surface, settings)
    if settings.sides == "cyclic":
        _check_opposite_sides(surface)
    progress(f"cutting {len(surface.triangles)} triangles out of the duct")
    points, triangles, origin = box_minus(box, surface.points, surface.triangles)
    plane = _plane_of(points, triangles, origin, box)
    keep, pockets, lost = _flowing(points, triangles, plane)
    if pockets:
        progress(f"left out {pockets} closed pockets of air, {lost / box.volume:.2e} of the duct")
    points, triangles, origin, plane = *_used(points, triangles[keep]), origin[keep], plane[keep]
    patch = np.array([*(PATCHES.index(name) for name in _PLANES), PATCHES.index(FIBERS)])[plane]
    fiber = np.where(origin >= 0, surface.fiber[np.maximum(origin, 0)], -1)
    return FluidDomain(
        points, triangles, patch, PATCHES, fiber, surface.radius, box, surface.slab, surface.pieces,
        cyclic=settings.sides == "cyclic",
    )  # fmt: skip


def _check_opposite_sides(surface: Surface) -> None:
    # a corner's edge is a third of a diameter at the default: rounding may set one more point on it, which is no harm
    near = 0.6 * float(surface.radius.min())
    for axis, name in ((0, "x"), (1, "y")):
        low, high = (
            np.delete(surface.points[surface.points[:, axis] == side], axis, axis=1)
            for side in (surface.slab.lower[axis], surface.slab.upper[axis])
        )
        alone = _without_partner(low, high, near) + _without_partner(high, low, near)
        if alone:
            raise CaseError(
                f'enclosure.sides = "cyclic" needs a periodic mat: {alone} of {len(low) + len(high)} points on the '
                f'sides across {name} have no partner opposite; set mat.periodic = true or enclosure.sides = "symmetry"'
            )


def _without_partner(points: Floats, others: Floats, near: float) -> int:
    if len(points) == 0 or len(others) == 0:
        return len(points)
    return int(np.count_nonzero(cKDTree(others).query(points)[0] > near))


def _plane_of(points: Floats, triangles: Ints, origin: Ints, box: Box) -> Ints:
    """Plane of the box that each triangle lies on, 6 for the fibers."""
    plane = np.where(origin < 0, -1 - origin, 6)
    for k in range(6):
        axis, place = k // 2, (box.lower, box.upper)[k % 2][k // 2]
        off = int((points[triangles[plane == k]][:, :, axis] != place).any(axis=1).sum())
        if off:
            raise ValueError(f"{off} triangles of the plane {_PLANES[k]} are not exactly on it")
    return plane


def _flowing(points: Floats, triangles: Ints, plane: Ints) -> tuple[npt.NDArray[np.bool_], int, float]:
    """Find the triangles around the air that flows; count the closed pockets and their volume."""
    piece = connected_pieces(triangles)
    inlet, outlet = (piece[plane == _PLANES.index(name)] for name in (INLET, OUTLET))
    if inlet[0] != outlet[0]:  # both are whole rectangles, since fibers keep clear of them
        raise StageError(
            "the fibers close the duct: no air leads from the inlet to the outlet; use a larger mat.side or a "
            "smaller coverage"
        )
    volume = np.bincount(piece, weights=signed_volumes(points, triangles))
    # an outer shell encloses air; an inner one is a fiber that floats in it
    closed = np.flatnonzero((volume > 0) & (np.arange(len(volume)) != inlet[0]))
    dropped = [*closed]
    for floating in np.flatnonzero(volume < 0):
        place = points[triangles[piece == floating][0, 0]]
        if any(winding_number(points, triangles[piece == pocket], place) > 0.5 for pocket in closed):
            dropped.append(floating)
    return ~np.isin(piece, dropped), len(closed), float(volume[dropped].sum())


def _used(points: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    used, index = np.unique(triangles, return_inverse=True)
    return points[used], index.reshape(triangles.shape)
