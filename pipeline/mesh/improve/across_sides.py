"""Put a mesh together across its cyclic sides, so that what lies beside them is improved as any other place is.

Opposite sides are one to the solver: a vertex on one has a twin on the other, and what moves one has to move both. So
the duct is cut somewhere within instead, along faces, and what lies before the cut is moved on by one period: the sides
become a plane within the mesh, whose vertices stay on it. Seen from above, the parts in their places::

    +---+---+            +---+---+
    | c | d |            | d'| c'|        the sides are now the lines between the parts,
    +---+---+     ->     +---+---+        the cut is the outline
    | a | b |            | b | a'|
    +---+---+            +---+---+

Afterwards the parts go back. What lies beside a cut stays as it is until the next round, in which the cut is elsewhere.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass, replace

import numpy as np

from pipeline.geometry.adjacency import corners_of, neighbors
from pipeline.geometry.box import Box
from pipeline.geometry.fibers import FiberDistance
from pipeline.geometry.parts import parts
from pipeline.mesh.freedom import Freedom
from pipeline.mesh.working_mesh import LATER, WorkingMesh
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.patches import DUCT, LOWER

_SAME = 1e-6  # of a period: how far twins may differ
_SIDES = tuple(
    (patch.axis, np.uint8(1 << number), np.uint8(1 << DUCT.index(patch.opposite)))
    for number, patch in enumerate(DUCT)
    if patch.role == "side" and patch.end == LOWER and patch.axis is not None
)
"""Axis of each pair of sides, and the bits of the lower and the upper one."""
_PATCHES = [number for number, patch in enumerate(DUCT) if patch.role == "side"]


@dataclass(frozen=True, eq=False, slots=True)
class Shifted:
    """A mesh that goes on across its sides.

    Parameters
    ----------
    mesh : WorkingMesh
        Its vertices on the sides have the bits of the upper ones; it is cut within the duct.
    source : (n,) int array
        The same number for all that are one vertex in the duct or its twins, as both copies of one at the cut are.
    freedom : Freedom
        In the duct.
    """

    mesh: WorkingMesh
    source: Ints
    freedom: Freedom


@dataclass(frozen=True, eq=False, slots=True)
class _Periodic(FiberDistance):
    """Distance to fibers that go on past the duct: what lies beyond its upper sides is asked for a period before."""

    upper: Floats
    period: Floats

    def with_piece(self, points: Floats) -> tuple[Floats, Ints]:
        """Give distance and piece as `FiberDistance` does."""
        beyond = (points > self.upper) & (self.period > 0.0)
        return FiberDistance.with_piece(self, np.where(beyond, points - self.period, points))


def with_sides_kept(mesh: WorkingMesh) -> WorkingMesh:
    """Give a mesh that is improved in its duct: its cyclic sides are where it ends and goes on, and no boundary."""
    across = np.where(np.isin(-1 - mesh.across, _PATCHES), np.int32(LATER), mesh.across)
    return replace(mesh, across=across, freedom=replace(mesh.freedom, cyclic=False))


def with_sides(mesh: WorkingMesh, freedom: Freedom) -> WorkingMesh:
    """Give a mesh in its duct its cyclic sides back."""
    return WorkingMesh.of(mesh.points, mesh.tets, freedom)


def shifted(mesh: WorkingMesh, share: float) -> Shifted | None:
    """Cut a mesh somewhere in the duct instead of at its cyclic sides.

    Parameters
    ----------
    mesh : WorkingMesh
        Of a duct with cyclic sides.
    share : float [-]
        Where along x and y, from one side to the other.

    Returns
    -------
    Shifted, optional
        None where opposite sides do not carry the same triangles, or a cell reaches from one to the other.
    """
    twin = _twins(mesh)
    lower, upper = mesh.freedom.limits
    period = np.array([*(upper - lower)[:2], 0.0])
    on_lower, on_upper = (np.column_stack([mesh.planes & side[end] > 0 for side in _SIDES]) for end in (1, 2))
    at_lower, at_upper = on_lower[mesh.tets].any(axis=1), on_upper[mesh.tets].any(axis=1)
    if (at_lower & at_upper).any() or not _fit(mesh, twin):
        return None
    # cells before the cut go on by a period, be they so large that they reach beyond it
    moved = (mesh.points[mesh.tets].mean(axis=1) < lower + share * period)[:, :2]
    moved = (moved | at_lower) & ~at_upper
    # a vertex on an upper side is its twin, a period on
    place = on_upper[mesh.tets] + moved[:, None, :].astype(np.int64)
    names, first, corner = np.unique(
        np.column_stack([twin[mesh.tets].ravel(), place.reshape(-1, 2)]), axis=0, return_index=True, return_inverse=True
    )
    tets = np.asarray(corner.reshape(-1, 4), np.int32)
    vertex = mesh.tets.ravel()[first]
    points = mesh.points[vertex] + period * np.column_stack([moved[first // 4], np.zeros(len(first))])
    planes = mesh.planes[vertex].copy()
    for axis, low, high in _SIDES:
        there = (planes & (low | high)) > 0
        points[there, axis] = upper[axis]
        planes[there] = (planes[there] & ~low) | high
    across = neighbors(tets)
    cell, side = np.nonzero(across < 0)
    # a face on a side, too, has its two cells on both sides of the cut here and there
    before = mesh.across[cell, side]
    across[cell, side] = np.where((before >= 0) | np.isin(-1 - before, _PATCHES), LATER, before)
    freedom = replace(
        mesh.freedom,
        box=Box(mesh.freedom.box.lower, tuple((upper + period).tolist())),
        cyclic=False,
        distance=_Periodic(mesh.freedom.distance.field, np.where(period > 0.0, upper, np.inf), period),
    )
    return Shifted(WorkingMesh(points, tets, across, planes, freedom), names[:, 0], mesh.freedom)


def back_in_duct(whole: Shifted, mesh: WorkingMesh) -> WorkingMesh:
    """Put the parts of an improved mesh back into the duct.

    Parameters
    ----------
    whole : Shifted
        As it was before it was improved.
    mesh : WorkingMesh
        What became of its mesh: the first vertices are the same ones.

    Returns
    -------
    WorkingMesh
        Twins stand opposite to each other to the last bit.
    """
    lower, upper = whole.freedom.limits
    period = np.array([*(upper - lower)[:2], 0.0])
    count = int(whole.source.max()) + 1
    source = np.concatenate([whole.source, count + np.arange(len(mesh.points) - len(whole.source))])
    beyond = mesh.points[mesh.tets].mean(axis=1)[:, :2] > upper[:2]
    on_side = np.column_stack([mesh.planes & high > 0 for _, _, high in _SIDES])
    # a vertex on a side becomes two, one for the cells before it and one for those beyond
    place = (on_side[mesh.tets] & beyond[:, None, :]).astype(np.int64)
    _, first, corner = np.unique(
        np.column_stack([source[mesh.tets].ravel(), place.reshape(-1, 2)]),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    vertex = mesh.tets.ravel()[first]
    points = mesh.points[vertex] - period * np.column_stack([beyond[first // 4], np.zeros(len(first))])
    for axis, _, high in _SIDES:
        there = (mesh.planes[vertex] & high) > 0
        points[there, axis] = np.where(beyond[first // 4, axis], lower[axis], upper[axis])[there]
    return with_sides(replace(mesh, points=points, tets=np.asarray(corner.reshape(-1, 4), np.int32)), whole.freedom)


def _fit(mesh: WorkingMesh, twin: Ints) -> bool:
    """Whether opposite sides carry the same triangles, by the numbers of their vertices that twins share."""
    for number, patch in enumerate(DUCT):
        if patch.role != "side" or patch.end != LOWER:
            continue
        one, other = (
            np.unique(np.sort(twin[corners_of(mesh.tets, *np.nonzero(mesh.across == -1 - each))], axis=1), axis=0)
            for each in (number, DUCT.index(patch.opposite))
        )
        if not np.array_equal(one, other):
            return False
    return True


def _twins(mesh: WorkingMesh) -> Ints:
    """Give the same number to vertices opposite to each other, (n,) int array.

    A cell that only touches a side may do so where the air beyond is a fiber's: its vertex there has no twin.
    """
    from scipy.spatial import cKDTree

    lower, upper = mesh.freedom.limits
    used = np.zeros(len(mesh.points), np.bool_)
    used[mesh.tets] = True
    one, other = [], []
    for axis, low, high in _SIDES:
        below, above = (np.flatnonzero(used & ((mesh.planes & bit) > 0)) for bit in (low, high))
        if len(below) == 0:
            continue
        others = [each for each in range(3) if each != axis]
        gap, nearest = cKDTree(mesh.points[below][:, others]).query(mesh.points[above][:, others])
        same = np.asarray(gap) <= _SAME * (upper - lower)[axis]
        one.append(above[same])
        other.append(below[np.asarray(nearest)[same]])
    # at an edge of the duct up to four are one
    return (
        parts(np.concatenate(one), np.concatenate(other), len(mesh.points))[1] if one else np.arange(len(mesh.points))
    )
