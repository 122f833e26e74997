"""Flow with inertia past a cylinder between plates, against a published benchmark: `python -m validation.channel`.

Schäfer & Turek (1996), "Benchmark computations of laminar flow around a cylinder", test case 2D-1: a channel of
2.2 by 0.41 with a cylinder of diameter 0.1 at (0.2, 0.2), a parabolic inflow and a Reynolds number of 20 from the
mean velocity. The values here are those of Nabh (1998), by spectral elements: drag coefficient 5.57953523384,
lift 0.010618948146, pressure before the cylinder less that behind 0.11752016697 (over density and velocity squared,
of 0.2 m/s: 2.938004).

The elements and Newton's steps are those of the engine `stokes`, on a layer of prisms cut into tetrahedra; what differs
is the inflow, that the air stands still on the plates, and that linear equations are solved directly: multigrid is made
for the cells of filters, not for those that follow a wake over twenty diameters.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pipeline.geometry.tets import boundary, volumes
from pipeline.nouns.arrays import Bools, Floats, Ints
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.patches import FIBERS, INLET, OUTLET
from pipeline.progress import Progress, silent
from pipeline.solve.stokes.conditions import Conditions, no_slip
from pipeline.solve.stokes.creeping import creep
from pipeline.solve.stokes.duct import Duct
from pipeline.solve.stokes.inertia import with_inertia
from pipeline.solve.stokes.system import DIVERGENCE_WEIGHT, System

REYNOLDS = 20.0
MESHES = (6, 9, 13)
DRAG, LIFT, PRESSURE = 5.57953523384, 0.010618948146, 0.11752016697 / 0.2**2
"""Published coefficients of drag and lift, and the pressure's difference over density and mean velocity squared."""
# in diameters of the cylinder, from its middle
_LOW, _HIGH, _BEFORE, _BEHIND, _SQUARE = -2.0, 2.1, -2.0, 20.0, 1.5
_RING, _WAKE = 6.0, 8.0  # the last spacing over the first, about: from the cylinder out, and down the channel


@dataclass(frozen=True, slots=True)
class ChannelRun:
    """One mesh of the benchmark.

    Parameters
    ----------
    cells : int
    drag, lift, pressure : float [-]
        As `DRAG`, `LIFT` and `PRESSURE`.
    iterations : int
    """

    cells: int
    drag: float
    lift: float
    pressure: float
    iterations: int


class Channel(Duct):
    """A duct whose inflow is a parabola, and whose plates hold the air."""

    @cached_property
    def places(self) -> Floats:
        """Place of each unknown, (unknowns, 3) array."""
        places = np.zeros((self.matrices.unknowns, 3))
        places[self.unknown] = self.walls.positions
        return places

    @cached_property
    def plates(self) -> Bools:
        """Which unknowns are on the plates, but not where the air enters."""
        y = self.places[:, 1]
        return (np.isclose(y, 0.0) | np.isclose(y, _HIGH - _LOW)) & ~np.isclose(self.places[:, 2], 0.0)

    @cached_property
    def held(self) -> Ints:
        """Unknowns on the cylinder and on the plates."""
        return np.union1d(self.unknown[self.walls.wall], np.flatnonzero(self.plates))

    def conditions(self, slip_length: float) -> Conditions:
        """Hold the air on the cylinder and the plates, and let it enter as a parabola of mean 1 along z."""
        fixed, given = np.zeros((len(self.places), 3), np.uint8), np.zeros((len(self.places), 3))
        fixed[:, 0] = 1  # the flow is in a plane
        entrance, height = np.isclose(self.places[:, 2], 0.0), _HIGH - _LOW
        fixed[entrance] = 1
        y = self.places[entrance, 1]
        given[entrance, 2] = 6.0 * y * (height - y) / height**2
        return no_slip(fixed, given, self.held)


class DirectSystem(System):
    """The equations of a flow, whose changes are solved directly."""

    def linearize(self, x: Floats, both: bool) -> None:
        """Take the change of the equations about an iterate, and factor it."""
        from scipy.sparse import block_array, bsr_array, csr_array, identity, kron
        from scipy.sparse.linalg import splu

        super().linearize(x, both)
        m, n = self.matrices, self.matrices.unknowns
        force = kron(csr_array((self.stiff, m.column, m.start)), identity(3), format="csr")
        if len(self.bent):
            force = force + bsr_array((self.bent.astype(np.float64), m.column, m.start), shape=(3 * n, 3 * n)).tocsr()
        row = np.repeat(np.arange(m.vertices), 3 * np.diff(m.div_start))
        column = (3 * m.div_column[:, None].astype(np.int64) + np.arange(3)).ravel()
        div = csr_array((self.div.ravel(), (row, column)), shape=(m.vertices, 3 * n))
        free = np.flatnonzero(self.conditions.fixed.ravel() == 0)
        self.free = np.concatenate([free, self.split + np.arange(m.vertices)])
        whole = block_array(
            [[force[free][:, free], div[:, free].T], [DIVERGENCE_WEIGHT * div[:, free], None]], format="csc"
        )
        self.factors = splu(whole)

    def precondition(self, x: Floats) -> Floats:
        """Solve for the change that has this residual."""
        if self.convection is None:
            return super().precondition(x)
        found = np.zeros_like(x)
        found[self.free] = self.factors.solve(x[self.free])
        return found


def channel(cells: int) -> Channel:
    """Mesh the channel: `cells` on each side of the square about the cylinder, as many from it to the square."""
    flat, triangles = _plane(cells)
    depth = _SQUARE / cells
    points = np.concatenate([np.column_stack([np.full(len(flat), x), flat]) for x in (0.0, depth)])
    points -= [0.0, _LOW, _BEFORE]
    # three over each triangle; the diagonals of its sides start at the lower number, so neighbors fit
    a, b, c = np.sort(triangles, axis=1).T
    over = len(flat)
    tets = np.concatenate(
        [
            np.column_stack(t)
            for t in ((a, b, c, c + over), (a, b, b + over, c + over), (a, a + over, b + over, c + over))
        ]
    )
    turned = volumes(points, tets) < 0.0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    faces, _ = boundary(tets)
    upper = np.array([depth, _HIGH - _LOW, _BEHIND - _BEFORE])
    planes = {INLET: (2, 0.0), OUTLET: (2, upper[2]), "xmin": (0, 0.0), "xmax": (0, depth), "ymin": (1, 0.0)}
    named = {
        name: faces[np.isclose(points[faces][:, :, axis], at).all(axis=1)]
        for name, (axis, at) in {**planes, "ymax": (1, upper[1])}.items()
    }
    middle = np.array([0.0, -_LOW, -_BEFORE])
    on = np.isclose(np.linalg.norm((points[faces] - middle)[:, :, 1:], axis=2), 0.5).all(axis=1)
    end = np.array([depth, 0.0, 0.0])
    pieces = Pieces((middle - end)[None], (middle + 2.0 * end)[None], np.zeros(1, np.int64), np.ones((1, 2), bool))
    return Channel(points, tets, {**named, FIBERS: faces[on]}, pieces, np.array([0.5]), upper)


def _plane(cells: int) -> tuple[Floats, Ints]:
    """Points (y, z) and triangles of the channel's plane: rings about the cylinder, a grid everywhere else."""
    ones = np.full(cells, _SQUARE)
    edge = np.linspace(-_SQUARE, _SQUARE, cells + 1)[:-1]
    square = np.concatenate([np.column_stack(c) for c in ((edge, -ones), (ones, edge), (-edge, ones), (-ones, -edge))])
    circle = 0.5 * square / np.linalg.norm(square, axis=1)[:, None]
    share = (_RING ** np.linspace(0.0, 1.0, cells + 1) - 1.0) / (_RING - 1.0)
    ring = (circle + share[:, None, None] * (square - circle)).reshape(-1, 2)
    n, k = 4 * cells, np.arange(4 * cells)
    following = (k + 1) % n
    quads = [
        np.column_stack([n * j + k, n * (j + 1) + k, n * (j + 1) + following, n * j + following]) for j in range(cells)
    ]
    few = max(cells // 6, 1)
    y = np.concatenate([np.linspace(_LOW, -_SQUARE, few + 1)[:-1], [*edge], np.linspace(_SQUARE, _HIGH, few + 1)])
    wake = _SQUARE + (_BEHIND - _SQUARE) * (_WAKE ** np.linspace(0.0, 1.0, 2 * cells + 1) - 1.0) / (_WAKE - 1.0)
    z = np.concatenate([np.linspace(_BEFORE, -_SQUARE, few + 1)[:-1], [*edge], wake])
    grid = np.stack(np.meshgrid(y, z, indexing="ij"), axis=-1).reshape(-1, 2)
    first = (np.arange(len(y) - 1)[:, None] * len(z) + np.arange(len(z) - 1)).ravel()
    bricks = len(ring) + np.column_stack([first, first + len(z), first + len(z) + 1, first + 1])
    points = np.concatenate([ring, grid])
    inside = (np.abs(points[bricks].mean(axis=1)) < _SQUARE).all(axis=1)
    corners = np.concatenate([*quads, bricks[~inside]])
    _, where, index = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    used, numbers = np.unique(index.ravel()[corners], return_inverse=True)
    numbers = numbers.reshape(-1, 4)
    return points[where][used], np.concatenate([numbers[:, [0, 1, 2]], numbers[:, [0, 2, 3]]])


def past_a_cylinder(cells: int, progress: Progress = silent) -> ChannelRun:
    """Solve the benchmark on one mesh."""
    duct = channel(cells)

    def told(iterations: int, drop: float, error: float) -> None:
        progress(f"channel of {len(duct.tets):,} cells: iteration {iterations}, pressure drop {drop:.5g}")

    system = DirectSystem(duct, 0.0)
    found = with_inertia(system, REYNOLDS, 1e-5, 2000, told, creep(system, 1e-3, 2000, told))
    wall = np.unique(duct.unknown[duct.walls.wall])
    force = -found.force[wall].sum(axis=0) * 2.0 / (REYNOLDS * duct.upper[0])
    at = duct.places[: duct.matrices.vertices] - [0.0, -_LOW, -_BEFORE]
    front, back = (np.argmin(np.linalg.norm(at[:, 1:] - [0.0, z], axis=1)) for z in (-0.5, 0.5))
    pressure = float(found.pressure[front] - found.pressure[back]) / REYNOLDS
    return ChannelRun(len(duct.tets), float(force[2]), float(force[1]), pressure, found.iterations)


def table(meshes: tuple[int, ...] = MESHES) -> str:
    """Solve on all meshes, and lay the coefficients out beside the published ones."""
    lines = [
        "| cells | drag | error | lift | error | pressure before less behind | error |",
        "|---|---|---|---|---|---|---|",
    ]
    for cells in meshes:
        run = past_a_cylinder(cells)
        pairs = ((run.drag, DRAG), (run.lift, LIFT), (run.pressure, PRESSURE))
        told = " | ".join(f"{value:.5f} | {100.0 * (value / exact - 1.0):+.2f} %" for value, exact in pairs)
        lines.append(f"| {run.cells:,} | {told} |")
    return "\n".join([*lines, f"| published | {DRAG:.5f} | | {LIFT:.5f} | | {PRESSURE:.5f} | |"])


if __name__ == "__main__":
    sys.stdout.write(table() + "\n")
