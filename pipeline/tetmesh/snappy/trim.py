"""Give cells that no solver can use to the fibers, and keep what hangs together.

Where a fiber grazes a side of the duct the air ends in a wedge. A cell in its tip has a face on either and is open
along the wedge alone: its inner faces look two opposite ways, so that no gradient is known in it (determinant 0).
The air in there stands still.
"""

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pipeline.data import FaceMesh, Ints, Patch
from pipeline.geometry.faces import compacted
from pipeline.geometry.polyhedra import determinants, polygons

Mask = npt.NDArray[np.bool_]


LEAST_DETERMINANT = 1.1e-3
"""A little above what checkMesh asks for."""


def blind(mesh: FaceMesh, patch: str) -> tuple[Mask, int]:
    """Find the cells at a patch in which no gradient is known, once those before them are gone.

    Parameters
    ----------
    mesh : FaceMesh
    patch : str

    Returns
    -------
    dropped : (cells,) bool array
        Cells with a corner on the patch, or on a cell that is dropped, and a determinant below `LEAST_DETERMINANT`.
    left : int
        Number of other cells whose determinant is as low.
    """
    n = mesh.internal
    areas, _ = polygons(mesh.points, mesh.corners, mesh.offsets[: n + 1])
    which = mesh.patch(patch)
    at_wall = np.zeros(len(mesh.points), dtype=bool)
    at_wall[mesh.corners[mesh.offsets[which.start] : mesh.offsets[which.stop]]] = True
    kept = np.ones(mesh.cells, dtype=bool)
    while True:
        inner = np.flatnonzero(kept[mesh.owner[:n]] & kept[mesh.neighbour])
        low = determinants(areas[inner], mesh.owner[inner], mesh.neighbour[inner], mesh.cells) < LEAST_DETERMINANT
        low &= kept
        dropped = low & _of_cells(mesh, np.logical_or.reduceat(at_wall[mesh.corners], mesh.offsets[:-1]))
        if not dropped.any():
            return ~kept, int(low.sum())
        kept &= ~dropped
        at_wall[points_of(mesh, dropped)] = True


def _of_cells(mesh: FaceMesh, face: Mask) -> Mask:
    """Find the cells that have one of some faces."""
    result = np.zeros(mesh.cells, dtype=bool)
    result[mesh.owner[face]] = True
    result[mesh.neighbour[face[: mesh.internal]]] = True
    return result


def points_of(mesh: FaceMesh, cells: Mask) -> Ints:
    """Points of some cells."""
    face = cells[mesh.owner]
    face[: mesh.internal] |= cells[mesh.neighbour]
    return np.unique(mesh.corners[np.repeat(face, np.diff(mesh.offsets))])


def without(mesh: FaceMesh, dropped: Mask, patch: str) -> FaceMesh:
    """Give the mesh without some cells, and without any that then hang together with the rest no longer.

    Parameters
    ----------
    mesh : FaceMesh
    dropped : (cells,) bool array
    patch : str
        The last patch: faces that lose a cell belong to it from now on.

    Returns
    -------
    FaceMesh
        Cells and faces keep their order; the largest part of the mesh is kept.
    """
    if mesh.patches[-1].name != patch:
        raise ValueError(f"{patch} is not the last patch")
    n = mesh.internal
    kept = ~dropped & _largest_part(mesh, ~dropped)
    own, other = kept[mesh.owner], kept[mesh.neighbour]
    inner = np.flatnonzero(own[:n] & other)
    bared = np.flatnonzero(own[:n] != other)
    # where the owner goes, the face looks out of the other cell from now on
    flipped = ~own[bared]
    number = np.cumsum(kept) - 1
    bared_owner = np.where(flipped, mesh.neighbour[bared], mesh.owner[bared])
    outer = n + np.flatnonzero(own[n:])

    faces = np.concatenate([inner, outer, bared])
    flip = np.zeros(len(faces), dtype=bool)
    flip[len(faces) - len(bared) :] = flipped
    owner = number[np.concatenate([mesh.owner[inner], mesh.owner[outer], bared_owner])]
    old_last = mesh.patches[-1].start
    # the last patch in the order of its cells again
    last = len(inner) + int(np.count_nonzero(outer < old_last))
    order = np.concatenate([np.arange(last), last + np.argsort(owner[last:], kind="stable")])
    corners, offsets = _picked(mesh, faces[order], flip[order])
    points, corners = compacted(mesh.points, corners)
    counts = [int(np.count_nonzero(own[each.start : each.start + each.count])) for each in mesh.patches]
    counts[-1] += len(bared)
    starts = len(inner) + np.cumsum(counts) - counts
    return FaceMesh(
        points=points,
        corners=corners,
        offsets=offsets,
        owner=owner[order],
        neighbour=number[mesh.neighbour[inner]],
        cells=int(kept.sum()),
        patches=tuple(
            Patch(each.name, int(start), count) for each, start, count in zip(mesh.patches, starts, counts, strict=True)
        ),
    )


def _picked(mesh: FaceMesh, faces: Ints, flip: Mask) -> tuple[Ints, Ints]:
    """Corners and offsets of some faces, those to flip the other way round."""
    sizes = np.diff(mesh.offsets)[faces]
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    place = np.arange(offsets[-1]) - np.repeat(offsets[:-1], sizes)
    backward = np.repeat(sizes - 1, sizes) - place
    place = np.where(np.repeat(flip, sizes), backward, place)
    return mesh.corners[np.repeat(mesh.offsets[faces], sizes) + place], offsets


def _largest_part(mesh: FaceMesh, kept: Mask) -> Mask:
    own, other = mesh.owner[: mesh.internal], mesh.neighbour
    joined = kept[own] & kept[other]
    links = coo_array((np.ones(int(joined.sum()), np.int8), (own[joined], other[joined])), shape=(mesh.cells,) * 2)
    _, part = connected_components(links, directed=False)
    result: Mask = part == np.bincount(part[kept]).argmax()
    return result
