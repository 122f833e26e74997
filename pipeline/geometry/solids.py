"""Booleans of closed triangle surfaces; the only door to manifold3d."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.geometry.triangles import Floats, Ints

if TYPE_CHECKING:
    from manifold3d import Manifold

Body = tuple[Floats, Ints]
"""Points and outward triangles of one closed surface."""

BOX_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
BOX_TRIANGLES = np.array(
    [
        *([0, 1, 3], [0, 3, 2]),  # xmin
        *([4, 6, 7], [4, 7, 5]),  # xmax
        *([0, 4, 5], [0, 5, 1]),  # ymin
        *([2, 3, 7], [2, 7, 6]),  # ymax
        *([0, 2, 6], [0, 6, 4]),  # zmin
        *([1, 5, 7], [1, 7, 3]),  # zmax
    ]
)
"""A box's outward triangles, two for each plane, planes in the order xmin, xmax, ymin, ymax, zmin, zmax."""

_PLANE = np.repeat(np.arange(6), 2)

_SNAP = 1e-11  # of the working size, which is of order one: what a plane's points may be off by rounding alone


def box_body(box: Box) -> Body:
    """Give the box as a closed surface of twelve triangles.

    Examples
    --------
    >>> from pipeline.geometry.triangles import enclosed_volume
    >>> round(enclosed_volume(*box_body(Box((0, 0, 0), (1, 2, 3)))), 12)
    6.0
    """
    return np.where(BOX_CORNERS == 0, np.array(box.lower, float), np.array(box.upper, float)), BOX_TRIANGLES


def unite_within(bodies: Sequence[Body], limits: Box) -> tuple[Floats, Ints, Ints]:
    """Unite closed bodies and keep what lies within a box.

    Parameters
    ----------
    bodies : sequence of (points, triangles)
        Each closed, outward and free of self-intersection; they may overlap and touch. Voids that they close in
        between them are filled.
    limits : Box [m]
        Points of the cuts lie exactly, bit by bit, on its planes.

    Returns
    -------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        Outward.
    body : (m,) int array
        Which body a triangle came from; ``-1 - plane`` on the cuts, planes as in `BOX_TRIANGLES`.
        No triangle at all where nothing lies within the box.

    Raises
    ------
    StageError
        If a body is not a closed surface, or the union fails.
    """
    from manifold3d import Manifold, OpType

    scale = _scale(limits)
    first = Manifold.reserve_ids(len(bodies) + 1)
    solids = [
        _solid(points, triangles, scale, f"body {k}", first + k, np.arange(len(triangles)))
        for k, (points, triangles) in enumerate(bodies)
    ]
    whole = _sound(Manifold.batch_boolean(solids, OpType.Add), f"the union of {len(bodies)} bodies")
    cutter = _solid(*box_body(limits), scale, "the box", first + len(bodies), _PLANE)
    kept = _filled(_sound(whole ^ cutter, f"the cut of {len(bodies)} united bodies at the box"))
    points, triangles, source, face = _arrays(kept, scale, limits)
    return points, triangles, np.where(source == first + len(bodies), -1 - face, source - first)


def volume_within(bodies: Sequence[Body], limits: Box) -> float:
    """Volume of the union of closed bodies within a box.

    Parameters
    ----------
    bodies : sequence of (points, triangles)
        As for `unite_within`.
    limits : Box [m]

    Returns
    -------
    float [m3]

    Raises
    ------
    StageError
        If a body is not a closed surface, or the union fails.
    """
    from manifold3d import Manifold, OpType

    scale = _scale(limits)
    solids = [_solid(points, triangles, scale, "a body", 0, np.arange(len(triangles))) for points, triangles in bodies]
    cutter = _solid(*box_body(limits), scale, "the box", 0, _PLANE)
    cut = _sound(Manifold.batch_boolean(solids, OpType.Add) ^ cutter, "the cut of a body at the box")
    return float(cut.volume()) / scale**3


def box_minus(box: Box, points: Floats, triangles: Ints) -> tuple[Floats, Ints, Ints]:
    """Cut closed bodies out of a box.

    Parameters
    ----------
    box : Box [m]
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        The bodies, closed and outward. A face of theirs that lies exactly on a plane of the box opens that plane.

    Returns
    -------
    points : (k, 3) array [m]
    triangles : (l, 3) int array
        Counterclockwise seen from outside what is left.
    origin : (l,) int array
        Triangle of the bodies that each one is a part of; ``-1 - plane`` on the box, planes as in `BOX_TRIANGLES`.

    Raises
    ------
    StageError
        If the bodies are not closed, or the difference fails.
    """
    from manifold3d import Manifold

    scale = _scale(box)
    first = Manifold.reserve_ids(2)
    whole = _solid(*box_body(box), scale, "the box", first, _PLANE)
    cut = _solid(points, triangles, scale, "the surface", first + 1, np.arange(len(triangles)))
    left = _sound(whole - cut, "the box minus the surface")
    points, triangles, source, face = _arrays(left, scale, box)
    return points, triangles, np.where(source == first, -1 - face, face)


def _scale(box: Box) -> float:
    # a power of two: scaling in and out changes no digit, and a plane stays the same plane
    return 2.0 ** -round(math.log2(max(box.size)))


def _solid(points: Floats, triangles: Ints, scale: float, name: str, number: int, face: Ints) -> "Manifold":
    from manifold3d import Manifold, Mesh64

    mesh = Mesh64(
        vert_properties=np.ascontiguousarray(points * scale),
        tri_verts=np.ascontiguousarray(triangles, dtype=np.uint64),
        run_index=np.array([0, triangles.size], dtype=np.uint64),
        run_original_id=np.array([number], dtype=np.uint32),
        # a face of its own for each triangle: manifold3d would melt coplanar rings into long thin triangles
        face_id=np.ascontiguousarray(face, dtype=np.uint64),
    )
    return _sound(Manifold(mesh), name)


def _sound(solid: "Manifold", name: str) -> "Manifold":
    from manifold3d import Error

    # manifold3d's errors are states, not exceptions: nothing else would tell
    status = solid.status()
    if status != Error.NoError:
        raise StageError(
            f"{name} is no valid solid ({status.name}); check the fibers for bends of less than a diameter"
        )
    return solid


def _filled(solid: "Manifold") -> "Manifold":
    """Fill the voids that no air can reach from outside."""
    from manifold3d import Manifold, OpType

    shells = solid.decompose()
    outer = [shell for shell in shells if shell.volume() > 0]
    if len(outer) == len(shells):
        return solid
    # united again without the inner shells: what floated in a void is swallowed with it
    return _sound(Manifold.batch_boolean(outer, OpType.Add), f"the union of {len(outer)} filled parts")


def _arrays(solid: "Manifold", scale: float, box: Box) -> tuple[Floats, Ints, Ints, Ints]:
    mesh = solid.to_mesh64()
    points = np.array(mesh.vert_properties[:, :3], dtype=np.float64)
    triangles = np.array(mesh.tri_verts, dtype=np.int64)
    run = np.array(mesh.run_index, dtype=np.int64)
    source = np.repeat(np.asarray(mesh.run_original_id, dtype=np.int64), (run[1:] - run[:-1]) // 3)
    face = np.array(mesh.face_id, dtype=np.int64)
    for plane in (np.array(box.lower) * scale, np.array(box.upper) * scale):
        points = np.where(np.abs(points - plane) <= _SNAP, plane, points)
    return points / scale, triangles, source, face
