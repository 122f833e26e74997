"""Opposite sides that are one to a solver: face k of one is face k of the other, shifted."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace

import numpy as np

from pipeline.errors import StageError
from pipeline.geometry.cells import rows_of
from pipeline.nouns.arrays import Ints
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.nouns.patches import BY_NAME, DUCT, LOWER

TOLERANCE = 1e-6
"""Largest distance of two corners that are the same, over the distance of the sides; OpenFOAM takes 1e-4."""


def with_matching_sides(mesh: FaceMesh) -> FaceMesh:
    """Give the mesh with the faces of `xmax` and `ymax` in the order of those of `xmin` and `ymin`.

    Parameters
    ----------
    mesh : FaceMesh
        Of triangles.

    Returns
    -------
    FaceMesh
        Matching faces start with the same corner and run the opposite way round.

    Raises
    ------
    StageError
        If two opposite sides do not carry the same triangles.
    """
    triangles, owner = mesh.triangles().copy(), mesh.owner.copy()
    patches = {patch.name: patch for patch in mesh.patches}
    for low, high in ((side.name, side.opposite.name) for side in DUCT if side.role == "side" and side.end == LOWER):
        if low in patches or high in patches:
            _match(mesh, patches, low, high, triangles, owner)
    return replace(mesh, corners=triangles.ravel(), owner=owner)


def _match(mesh: FaceMesh, patches: dict[str, Patch], low: str, high: str, triangles: Ints, owner: Ints) -> None:
    if {low, high} - patches.keys() or patches[low].count != patches[high].count:
        counts = " and ".join(str(patches[name].count) if name in patches else "no" for name in (low, high))
        raise _refusal(low, high, f"have {counts} faces")
    rows = {name: slice(patches[name].start, patches[name].start + patches[name].count) for name in (low, high)}
    axis = BY_NAME[low].axis
    assert axis is not None
    image = _images(mesh, triangles[rows[low]], triangles[rows[high]], axis)
    partner = rows_of(image[:, [0, 2, 1]], triangles[rows[high]]) if (image >= 0).all() else np.array([-1])
    if (partner < 0).any():
        lonely = int((partner < 0).sum()) if len(partner) == len(image) else int((image < 0).any(axis=1).sum())
        raise _refusal(low, high, f"do not fit: {lonely} of {len(image)} triangles of {low} have no partner")
    triangles[rows[high]] = image[:, [0, 2, 1]]
    owner[rows[high]] = owner[rows[high]][partner]


def _images(mesh: FaceMesh, low: Ints, high: Ints, axis: int) -> Ints:
    """Point of the upper side opposite to each corner on the lower one, -1 where there is none."""
    from scipy.spatial import cKDTree

    below, above = np.unique(low), np.unique(high)
    size = float(mesh.points[above, axis].mean() - mesh.points[below, axis].mean())
    others = np.delete(np.arange(3), axis)
    gap, nearest = cKDTree(mesh.points[above][:, others]).query(mesh.points[below][:, others])
    number = np.full(len(mesh.points), -1)
    number[below] = np.where(gap <= TOLERANCE * size, above[nearest], -1)
    return number[low]


def _refusal(low: str, high: str, why: str) -> StageError:
    return StageError(
        f"cyclic sides need the same triangles on {low} and {high}, which {why}; "
        "set tetmesh.engine to lattice, whose sides fit for a periodic mat, or enclosure.sides to symmetry"
    )
