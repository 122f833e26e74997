"""Meshes made of the faces of another: some cells joined, or some left out."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.faces import compacted
from pipeline.geometry.parts import largest_part
from pipeline.nouns.arrays import Ints
from pipeline.nouns.mesh import FaceMesh, Patch

Mask = npt.NDArray[np.bool_]


def joined(mesh: FaceMesh, into: Ints) -> tuple[FaceMesh, Ints]:
    """Give the mesh with some cells joined to others, without the faces in between.

    Parameters
    ----------
    mesh : FaceMesh
    into : (cells,) int array
        Cell that each one becomes a part of; a cell that others join stays itself.

    Returns
    -------
    FaceMesh
    number : (cells,) int array
        What each cell has become.
    """
    n = mesh.internal
    stays = into == np.arange(mesh.cells)
    number = (np.cumsum(stays) - 1)[into]
    own, other = number[mesh.owner[:n]], number[mesh.neighbour]
    first, second = np.minimum(own, other), np.maximum(own, other)
    order = np.lexsort((second, first))
    inner = order[own[order] != other[order]]
    outer = np.arange(n, mesh.faces)
    flip = np.concatenate([(own > other)[inner], np.zeros(len(outer), dtype=bool)])
    owner = np.concatenate([first[inner], number[mesh.owner[n:]]])
    counts = [patch.count for patch in mesh.patches]
    made = _assembled(mesh, np.concatenate([inner, outer]), flip, owner, second[inner], int(stays.sum()), counts)
    return made, number


def without(mesh: FaceMesh, dropped: Mask, patch: str) -> FaceMesh:
    """Give the mesh without some cells, and without those that then hang together with the rest no longer.

    Parameters
    ----------
    mesh : FaceMesh
    dropped : (cells,) bool array
    patch : str
        The last patch: faces that lose a cell belong to it from now on.

    Returns
    -------
    FaceMesh
        The largest part that is left; its cells keep their order.
    """
    if mesh.patches[-1].name != patch:
        raise ValueError(f"{patch} is not the last patch")
    n = mesh.internal
    kept = largest_part(mesh.owner[: mesh.internal], mesh.neighbour, ~dropped)
    number = np.cumsum(kept) - 1
    own, other = kept[mesh.owner], kept[mesh.neighbour]
    inner = np.flatnonzero(own[:n] & other)
    outer = n + np.flatnonzero(own[n:])
    bared = np.flatnonzero(own[:n] != other)
    faces = np.concatenate([inner, outer, bared])
    # where the owner goes, the face looks out of the other cell from now on
    flip = np.concatenate([np.zeros(len(faces) - len(bared), dtype=bool), ~own[bared]])
    owner = mesh.owner[faces]
    owner[flip] = mesh.neighbour[faces[flip]]
    counts = [int(own[each.start : each.start + each.count].sum()) for each in mesh.patches]
    counts[-1] += len(bared)
    return _assembled(mesh, faces, flip, number[owner], number[mesh.neighbour[inner]], int(kept.sum()), counts)


def _assembled(
    mesh: FaceMesh, faces: Ints, flip: Mask, owner: Ints, neighbour: Ints, cells: int, counts: list[int]
) -> FaceMesh:
    """Make a mesh of some faces, some of them turned round; `counts` are those of the patches' faces."""
    sizes = np.diff(mesh.offsets)[faces]
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    place = np.arange(offsets[-1]) - np.repeat(offsets[:-1], sizes)
    place = np.where(np.repeat(flip, sizes), np.repeat(sizes - 1, sizes) - place, place)
    points, corners = compacted(mesh.points, mesh.corners[np.repeat(mesh.offsets[faces], sizes) + place])
    starts = len(neighbour) + np.cumsum(counts) - counts
    patches = tuple(
        Patch(patch.name, int(start), count) for patch, start, count in zip(mesh.patches, starts, counts, strict=True)
    )
    return FaceMesh(points, corners, offsets, owner, neighbour, cells, patches)
