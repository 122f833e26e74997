"""The air in cells: tetrahedra, and any cells as faces between an owner and a neighbour."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass, field

import numpy as np

from pipeline.geometry.faces import TetFaces, tets_of_faces
from pipeline.geometry.polyhedra import Polyhedra, fanned, polyhedra
from pipeline.geometry.triangles import enclosed_volume
from pipeline.nouns.arrays import Floats, Ints, all_within, freeze, require
from pipeline.nouns.patches import FIBERS

FLAT = ("empty", "wedge")
CYCLIC = "cyclic"


@dataclass(frozen=True, slots=True)
class Patch:
    """A named run of boundary faces: ``faces[start:start + count]``.

    `kind` is one of `FLAT` where OpenFOAM's type says that the mesh has fewer than three dimensions, `CYCLIC` where the
    mesh goes on through an opposite patch, else ``"patch"``.
    """

    name: str
    start: int
    count: int
    kind: str = "patch"


@dataclass(frozen=True, eq=False, slots=True)
class FaceMesh:
    """A mesh the way a finite-volume solver holds it: polygons between an owner and a neighbour.

    Parameters
    ----------
    points : (n, 3) array [m]
    corners : (k,) int array
        Vertices of all faces, one face after the other.
    offsets : (faces + 1,) int array
        Face f is ``corners[offsets[f]:offsets[f + 1]]``, counterclockwise seen from outside its owner.
    owner : (faces,) int array
        The cell of lower index at each face.
    neighbour : (internal,) int array
        The other cell of the first `internal` faces; these are sorted by (owner, neighbour).
    cells : int
    patches : tuple of Patch
        Boundary faces, in runs that follow each other from face `internal` to the last.
    fiber : (faces of the fibers' patch,) int array
        Number in the mat of the fiber that each of its faces stands for, -1 where none is near; empty for a mesh of
        others' making, of which nobody knows.
    """

    points: Floats
    corners: Ints
    offsets: Ints
    owner: Ints
    neighbour: Ints
    cells: int
    patches: tuple[Patch, ...]
    fiber: Ints = field(default_factory=lambda: np.empty(0, np.int64))

    def __post_init__(self) -> None:
        freeze(
            self,
            points=np.asarray(self.points, np.float64),
            corners=np.asarray(self.corners, np.int64),
            offsets=np.asarray(self.offsets, np.int64),
            owner=np.asarray(self.owner, np.int64),
            neighbour=np.asarray(self.neighbour, np.int64),
            fiber=np.asarray(self.fiber, np.int64),
        )
        require(len(self.offsets) == len(self.owner) + 1, "offsets and owners differ in length")
        require(self.points.ndim == 2 and self.points.shape[1] == 3, "points have three coordinates")
        require(bool(np.isfinite(self.points).all()), "a point is not finite")
        spans = self.offsets[0] == 0 and self.offsets[-1] == len(self.corners)
        require(bool(spans and (np.diff(self.offsets) >= 3).all()), "the offsets do not cut the corners into polygons")
        require(all_within(self.corners, len(self.points)), "a face has a corner that is no point")
        require(all_within(self.owner, self.cells), "a face has an owner that is no cell")
        require(all_within(self.neighbour, self.cells), "a face has a neighbour that is no cell")
        internal = len(self.neighbour)
        require(internal <= len(self.owner), "there are more neighbours than owners")
        # a label that lies would make every array over the cells huge
        require(
            self.cells <= len(self.owner) + internal,
            f"its labels speak of {self.cells} cells, but it has only {len(self.owner)} faces",
        )
        require(bool((self.owner[:internal] < self.neighbour).all()), "an owner is not below its neighbour")
        end = internal
        for patch in self.patches:
            require(patch.start == end, f"patch {patch.name} does not start where the one before ends")
            end += patch.count
        require(end == len(self.owner), "the patches do not cover the boundary")
        walls = sum(patch.count for patch in self.patches if patch.name == FIBERS)
        require(len(self.fiber) in (0, walls), f"{len(self.fiber)} of {walls} faces of {FIBERS} name their fiber")

    @classmethod
    def of_triangles(cls, points: Floats, found: TetFaces, names: tuple[str, ...]) -> "FaceMesh":
        """Put tetrahedra together.

        Parameters
        ----------
        points : (n, 3) array [m]
            Each belongs to a face.
        found : TetFaces
            Their faces.
        names : tuple of str
            Of the patches; none is empty.
        """
        require(len(found.patch) <= len(names), "a boundary face names a patch that does not exist")
        counts = np.concatenate([found.patch, np.zeros(len(names) - len(found.patch), np.int64)])
        missing = [name for name, count in zip(names, counts, strict=True) if not count]
        require(not missing, f"no boundary face in patch {', '.join(missing)}")
        starts = len(found.neighbour) + np.cumsum(counts) - counts
        return cls(
            points=points,
            corners=found.triangles.ravel(),
            offsets=np.arange(0, found.triangles.size + 1, 3),
            owner=found.owner,
            neighbour=found.neighbour,
            cells=len(found.order),
            patches=tuple(
                Patch(name, int(start), int(count)) for name, start, count in zip(names, starts, counts, strict=True)
            ),
        )

    @property
    def faces(self) -> int:
        """Number of faces, internal and boundary."""
        return len(self.owner)

    @property
    def internal(self) -> int:
        """Number of faces between two cells."""
        return len(self.neighbour)

    @property
    def tetrahedral(self) -> bool:
        """Whether every face is a triangle and every cell has four of them."""
        if len(self.corners) != 3 * self.faces:
            return False
        faces_of = np.bincount(self.owner, minlength=self.cells) + np.bincount(self.neighbour, minlength=self.cells)
        return bool((faces_of == 4).all())

    @property
    def volume(self) -> float:
        """Volume of all cells [m3]."""
        return enclosed_volume(*self.boundary())

    def patch(self, name: str) -> slice:
        """Where the faces of a patch stand; KeyError if there is no such patch."""
        return {patch.name: slice(patch.start, patch.start + patch.count) for patch in self.patches}[name]

    def boundary(self) -> tuple[Floats, Ints]:
        """Give the boundary as a closed surface of triangles, outward: points (k, 3) [m] and triangles (t, 3)."""
        return fanned(self.points, self.corners, self.offsets[self.internal :])

    def triangles(self) -> Ints:
        """All faces as a (faces, 3) int array; ValueError if one has more than three corners."""
        require(len(self.corners) == 3 * self.faces, "a face is no triangle")
        return self.corners.reshape(-1, 3)

    def tets(self) -> Ints:
        """Cells as a (cells, 4) int array of positive tetrahedra; ValueError if one is something else."""
        return tets_of_faces(self.triangles(), self.owner, self.neighbour, self.cells)

    def polyhedra(self) -> Polyhedra:
        """Areas and centers of the faces, volumes and centers of the cells."""
        return polyhedra(self.points, self.corners, self.offsets, self.owner, self.neighbour, self.cells)
