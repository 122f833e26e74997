"""A tile as a solver takes it: its faces toward other tiles in patches, in an order that those find too."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.faces import tet_faces
from pipeline.mesh.tiles.make import PieceMesh, first_of_each
from pipeline.mesh.working_mesh import LATER
from pipeline.nouns.arrays import Bools, Ints
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.nouns.patches import PATCHES


@dataclass(frozen=True, eq=False, slots=True)
class Tile:
    """A tile of a mesh.

    Parameters
    ----------
    mesh : FaceMesh
        With all patches of the duct, some of no face; then one for each tile that it borders on, whose face k is face
        k of that tile's patch for it, seen from the other side and beginning with the same corner.
    neighbors : tuple of int
        These tiles, in the order of their patches.
    order : (cells,) int array
        Cell k is the piece's ``order[k]``.
    """

    mesh: FaceMesh
    neighbors: tuple[int, ...]
    order: Ints


def name_toward(tile: int, other: int) -> str:
    """Give a tile's patch toward another one its name, as `decomposePar` does."""
    return f"procBoundary{tile}to{other}"


def tile_of(number: int, piece: PieceMesh, chosen: Bools) -> Tile:
    """List the faces of a tile.

    Parameters
    ----------
    number : int
        Of the tile.
    piece : PieceMesh
    chosen : (m,) bool array
        Cells to keep: whole parts, which share no face with the others.

    Returns
    -------
    Tile
    """
    used = np.zeros(len(piece.points), np.bool_)
    used[piece.tets[chosen]] = True
    tets = (np.cumsum(used) - 1)[piece.tets[chosen]]
    rows = np.where(chosen, np.cumsum(chosen) - 1, 0)
    beyond = piece.across[chosen]
    beyond = np.where(beyond >= 0, rows[np.maximum(beyond, 0)], beyond)
    outside = beyond <= LATER
    others = LATER - 1 - beyond[outside]
    if (others < 0).any():
        raise ValueError("a tile borders on what no piece has repaired")
    toward, row = np.unique(others, return_inverse=True)
    beyond[outside] = -1 - len(PATCHES) - row
    found = tet_faces(tets, beyond.astype(np.int32))
    counts = np.zeros(len(PATCHES) + len(toward), np.int64)
    counts[: len(found.patch)] = found.patch
    starts = len(found.neighbour) + np.cumsum(counts) - counts
    names = (*PATCHES, *(name_toward(number, other) for other in toward.tolist()))
    patches = tuple(Patch(*each) for each in zip(names, starts.tolist(), counts.tolist(), strict=True))
    triangles, owner = np.array(found.triangles), np.array(found.owner)
    _, rank = first_of_each(piece.names[used])
    for patch in patches[len(PATCHES) :]:
        here = slice(patch.start, patch.start + patch.count)
        order, turned = _by_name(triangles[here], rank)
        triangles[here], owner[here] = turned, owner[here][order]
    mesh = FaceMesh(
        points=piece.points[used],
        corners=triangles.ravel(),
        offsets=np.arange(0, triangles.size + 1, 3),
        owner=owner,
        neighbour=found.neighbour,
        cells=len(tets),
        patches=patches,
    )
    return Tile(mesh, tuple(toward.tolist()), np.flatnonzero(chosen)[found.order])


def _by_name(faces: Ints, rank: Ints) -> tuple[Ints, Ints]:
    """Order triangles by the ranks of their corners, each from the lowest on: the order, and the triangles in it."""
    ranks = rank[faces]
    turned = np.take_along_axis(faces, (ranks.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    order = np.lexsort(np.sort(ranks, axis=1).T[::-1])
    return order, turned[order]


def beside_others(piece: PieceMesh) -> tuple[FaceMesh, Bools]:
    """Give a tile with the cells of others behind its faces, and tell which cells are its own.

    A face between two tiles is as good as the cells on both sides make it.
    """
    tets = np.concatenate([piece.tets, piece.behind])
    found = tet_faces(tets)
    mesh = FaceMesh(
        points=piece.points,
        corners=found.triangles.ravel(),
        offsets=np.arange(0, found.triangles.size + 1, 3),
        owner=found.owner,
        neighbour=found.neighbour,
        cells=len(tets),
        patches=(Patch("boundary", len(found.neighbour), len(found.owner) - len(found.neighbour)),),
    )
    return mesh, np.asarray(found.order < len(piece.tets))
