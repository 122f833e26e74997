"""The mesh while it is improved: tetrahedra that know their neighbors, and what each of their vertices may do.

An engine makes it once. Improvements take one and give another, whose faces are not matched again: what a change of
some cells does to their neighbors is written where these cells are.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass, replace

import numpy as np

from pipeline.geometry.tets import Cells, Numbers
from pipeline.mesh.boundary import assign
from pipeline.mesh.freedom import Freedom, Planes
from pipeline.nouns.arrays import Bools, Floats, Ints
from pipeline.nouns.patches import FIBERS, PATCHES

WALL = -1 - PATCHES.index(FIBERS)
"""What stands for a neighbor at a wall; at patch number k it is -1 - k."""
INTERFACE = -1 - len(PATCHES)
"""What stands for a neighbor where a part ends and the mesh goes on: no boundary, and its triangles stay whole.

A number below it says so too, and that nobody puts the part back: the cells there have to stay.
"""
LATER = INTERFACE - 1
"""Of those numbers, the one that tells that both sides are worked on once more: what is wrong near there can wait."""


def on_boundary(across: Cells) -> Bools:
    """Tell which faces lie on a patch, by what stands for their neighbor."""
    return np.asarray((across < 0) & (across > INTERFACE))


@dataclass(frozen=True, eq=False, slots=True)
class WorkingMesh:
    """Tetrahedra of the air that may still change. Nobody writes to its arrays.

    Parameters
    ----------
    points : (n, 3) array [m]
        Some may belong to no cell.
    tets : (m, 4) int32 array
    across : (m, 4) int32 array
        Cell on the other side of each face, by local face as in `pipeline.geometry.tets.FACES`; -1 - k on the patch
        number k, `INTERFACE` where a part ends.
    planes : (n,) uint8 array
        On which planes of the duct each vertex lies, and stays.
    freedom : Freedom
        How far vertices may move.
    """

    points: Floats
    tets: Cells
    across: Cells
    planes: Planes
    freedom: Freedom

    @classmethod
    def of(cls, points: Floats, tets: Numbers, freedom: Freedom) -> "WorkingMesh":
        """Match the faces of tetrahedra, and find the patch of those on the boundary.

        Parameters
        ----------
        points : (n, 3) array [m]
            Those of the duct's planes lie on them to the last bit.
        tets : (m, 4) int array
            Positive.
        freedom : Freedom
        """
        # numba takes half a second to load, which no refused case file should cost
        from pipeline.geometry.adjacency import corners_of, neighbors

        across = neighbors(tets)
        cell, side = np.nonzero(across < 0)
        across[cell, side] = -1 - assign(points, corners_of(tets, cell, side), freedom.box, tolerance=0.0)
        return cls(points, np.ascontiguousarray(tets, np.int32), across, freedom.planes_at(points), freedom)

    @property
    def cells(self) -> int:
        """Number of tetrahedra."""
        return len(self.tets)

    def walls(self) -> Ints:
        """Triangles on the fibers, outward from the air, (b, 3) int array."""
        return self._faces(self.across == WALL)

    def boundary(self) -> tuple[Ints, Ints]:
        """Triangles on the boundary, outward, and the patch of each: (b, 3) and (b,) int arrays."""
        outside = on_boundary(self.across)
        return self._faces(outside), -1 - self.across[outside].astype(np.int64)

    def boundary_faces(self) -> Ints:
        """Count the faces that each cell has on the boundary, (m,) int array."""
        return np.asarray(on_boundary(self.across).sum(axis=1), np.int64)

    def _faces(self, which: Bools) -> Ints:
        from pipeline.geometry.adjacency import corners_of

        return corners_of(self.tets, *np.nonzero(which))

    def moved(self, points: Floats) -> "WorkingMesh":
        """Give the same cells with their vertices elsewhere."""
        return replace(self, points=points)

    def without(self, dropped: Bools) -> "WorkingMesh":
        """Leave cells out; those that remain have walls there.

        Parameters
        ----------
        dropped : (m,) bool array
        """
        if not dropped.any():
            return self
        number = np.where(dropped, WALL, np.cumsum(~dropped) - 1).astype(np.int32)
        across = self.across[~dropped]
        inner = across >= 0
        across[inner] = number[across[inner]]
        return replace(self, tets=self.tets[~dropped], across=across)

    def compacted(self) -> "WorkingMesh":
        """Drop the points that belong to no cell."""
        used = np.zeros(len(self.points), dtype=bool)
        used[self.tets] = True
        number = (np.cumsum(used) - 1).astype(np.int32)
        return replace(self, points=self.points[used], planes=self.planes[used], tets=number[self.tets])

    def main_cells(self) -> Bools:
        """Tell the cells that hang together: the largest part, or all parts that go on beyond an interface."""
        from pipeline.geometry.adjacency import largest_part_of
        from pipeline.geometry.parts import parts

        beyond = (self.across <= INTERFACE).any(axis=1)
        if not beyond.any():
            return largest_part_of(self.across)
        cell, side = np.nonzero(self.across >= 0)
        number, part = parts(cell, self.across[cell, side].astype(np.int64), self.cells)
        goes_on = np.zeros(number, np.bool_)
        goes_on[part[beyond]] = True
        return np.asarray(goes_on[part])

    def one_part(self) -> "WorkingMesh":
        """Keep the largest part that hangs together through faces, or all that go on beyond an interface."""
        return self.without(~self.main_cells())

    def held_vertices(self) -> Bools:
        """Tell the vertices that stay, since the cells behind an interface do not know what happens here."""
        held = np.zeros(len(self.points), np.bool_)
        held[self.tets[(self.across <= INTERFACE).any(axis=1)]] = True
        return held

    def part(self, cells: Ints) -> "Part":
        """Take some cells out, to be worked on alone.

        Parameters
        ----------
        cells : (k,) int array
            Ascending.
        """
        vertices, local = np.unique(self.tets[cells], return_inverse=True)
        across = self.across[cells].astype(np.int64)
        row = np.minimum(np.searchsorted(cells, across), len(cells) - 1)
        here = (across >= 0) & (cells[row] == across)
        inner = np.where(here, row, np.where(across >= 0, INTERFACE, across))
        mesh = WorkingMesh(
            self.points[vertices],
            np.asarray(local.reshape(-1, 4), np.int32),
            inner.astype(np.int32),
            self.planes[vertices],
            self.freedom,
        )
        return Part(mesh, cells, vertices.astype(np.int64))

    def with_part(self, part: "Part", improved: "WorkingMesh") -> "tuple[WorkingMesh, Ints]":
        """Put a part back after it was worked on.

        Parameters
        ----------
        part : Part
            As it was taken out of this mesh.
        improved : WorkingMesh
            What became of it; the triangles where it ends are the same ones, unless a cell there was left out.

        Returns
        -------
        WorkingMesh
        cells : (k,) int array
            Where the part's cells stand now.
        """
        from pipeline.geometry.adjacency import corners_of
        from pipeline.geometry.cells import rows_of

        extra = improved.points[len(part.vertices) :]
        vertex = np.concatenate([part.vertices, len(self.points) + np.arange(len(extra))])
        points = np.concatenate([self.points, extra])
        points[part.vertices] = improved.points[: len(part.vertices)]
        planes = np.concatenate([self.planes, improved.planes[len(part.vertices) :]])

        # cells that are there no more make room for new ones, and the last ones of the mesh move into what is left
        count = self.cells - len(part.cells) + improved.cells
        kept = min(len(part.cells), improved.cells)
        place = np.concatenate([part.cells[:kept], self.cells + np.arange(improved.cells - kept)])
        tets = np.concatenate([self.tets, np.empty((improved.cells - kept, 4), np.int32)])
        across = np.concatenate([self.across, np.empty((improved.cells - kept, 4), np.int32)])
        tets[place] = vertex[improved.tets]
        inner = improved.across >= 0
        across[place] = np.where(inner, place[np.where(inner, improved.across, 0)], improved.across)

        # where the part ends, its old faces name the cells beyond them
        cell, side = np.nonzero(part.mesh.across == INTERFACE)
        beyond = self.across[part.cells[cell], side]
        behind = (self.across[beyond] == part.cells[cell][:, None]).argmax(axis=1)
        now, at = np.nonzero(improved.across == INTERFACE)
        faces = corners_of(part.mesh.tets, cell, side)
        row = rows_of(corners_of(improved.tets, now, at), faces)
        across[beyond, behind] = WALL
        across[beyond[row], behind[row]] = place[now]
        across[place[now], at] = beyond[row]

        holes = part.cells[kept:]
        if len(holes):
            tets, across, place = _without_holes(tets, across, holes, place, count)
        return replace(self, points=points, tets=tets, across=across, planes=planes), place


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """Some cells of a mesh as a mesh of their own, with the numbers that they and their vertices have there.

    Parameters
    ----------
    mesh : WorkingMesh
    cells, vertices : int arrays
    """

    mesh: WorkingMesh
    cells: Ints
    vertices: Ints


def _without_holes(tets: Cells, across: Cells, holes: Ints, place: Ints, count: int) -> tuple[Cells, Cells, Ints]:
    """Move the last cells into rows that nobody uses any more."""
    used = np.ones(len(tets), dtype=bool)
    used[holes] = False
    into = np.flatnonzero(~used[:count])
    last = count + np.flatnonzero(used[count:])
    tets[into], across[into] = tets[last], across[last]
    number = np.full(len(tets), -1, np.int32)
    number[last] = into
    inside = across[into]
    # a cell that moves may border on another one that does
    moving = (inside >= 0) & (number[np.maximum(inside, 0)] >= 0)
    inside[moving] = number[inside[moving]]
    across[into] = inside
    row, side = np.nonzero(inside >= 0)
    other = inside[row, side]
    cell = last[row]
    slot, back = np.nonzero(across[other] == cell[:, None])
    across[other[slot], back] = into[row[slot]]
    moved = number[place]
    return tets[:count].copy(), across[:count].copy(), np.where(moved >= 0, moved, place)
