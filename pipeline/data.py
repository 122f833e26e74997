"""What flows from stage to stage. A thing that exists is valid: it is checked here, once, and frozen.

Arrays are read-only. Lengths are in meters, angles in radians, everything else in SI.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from pipeline.geometry.box import Box
from pipeline.geometry.faces import compacted, patch_of_faces, tet_faces, tets_of_faces
from pipeline.geometry.polyhedra import Polyhedra, fanned, polyhedra
from pipeline.geometry.tets import volumes
from pipeline.geometry.triangles import enclosed_volume, unmatched_edges

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
_Scalar = TypeVar("_Scalar", bound=np.generic)

INLET, OUTLET, FIBERS = "inlet", "outlet", "fibers"
SIDES = ("xmin", "xmax", "ymin", "ymax")
PATCHES = (INLET, OUTLET, *SIDES, FIBERS)
"""The patches of a duct, in the order in which they are written."""


def _frozen(array: npt.NDArray[_Scalar]) -> npt.NDArray[_Scalar]:
    copy = np.ascontiguousarray(array)
    if copy is array and array.flags.writeable:
        copy = array.copy()
    copy.flags.writeable = False
    return copy


def _freeze(thing: object, **arrays: npt.NDArray[np.generic]) -> None:
    # the one way to fill a frozen dataclass from its own __post_init__
    for name, array in arrays.items():
        object.__setattr__(thing, name, _frozen(array))


def _check(holds: bool, message: str) -> None:
    if not holds:
        raise ValueError(message)


def _all_within(numbers: Ints, count: int) -> bool:
    return numbers.size == 0 or (int(numbers.min()) >= 0 and int(numbers.max()) < count)


@dataclass(frozen=True, eq=False, slots=True)
class Mat:
    """A fiber mat: one polyline per fiber, in a slab that the flow crosses along +z.

    Parameters
    ----------
    nodes : (n, 3) array [m]
        Center lines, fiber after fiber. In a periodic mat they may leave the slab sideways: what leaves
        through one side enters through the opposite one.
    first : (fibers + 1,) int array
        Fiber k owns ``nodes[first[k]:first[k + 1]]``, at least two of them.
    radius : (fibers,) array [m]
        Above 0.
    slab : Box [m]
        The mat's own space: its plan, and z from 0 to its thickness.
    seed : int
        Seed of the generator that drew the mat; -1 for fibers that nobody drew.
    origin : str
        How the mat was made, for people to read.
    periodic : bool
        Whether the plan wraps in x and y.
    """

    nodes: Floats
    first: Ints
    radius: Floats
    slab: Box
    seed: int
    origin: str
    periodic: bool = False

    def __post_init__(self) -> None:
        _freeze(
            self,
            nodes=np.asarray(self.nodes, np.float64),
            first=np.asarray(self.first, np.int64),
            radius=np.asarray(self.radius, np.float64),
        )
        fibers = len(self.radius)
        _check(fibers > 0, "a mat has at least one fiber")
        _check(self.nodes.ndim == 2 and self.nodes.shape[1] == 3, "nodes have three coordinates")
        _check(self.first.shape == (fibers + 1,), f"{fibers} radii, but {len(self.first) - 1} center lines")
        _check(self.first[0] == 0 and self.first[-1] == len(self.nodes), "first does not span the nodes")
        _check(bool((np.diff(self.first) >= 2).all()), "a center line has fewer than two nodes")
        _check(bool(np.isfinite(self.nodes).all()), "a node is not finite")
        _check(bool(((self.radius > 0) & np.isfinite(self.radius)).all()), "a radius is not above 0")
        short = int((self.segment_lengths() <= 0).sum())
        _check(short == 0, f"{short} segments have no length")

    @property
    def fibers(self) -> int:
        """Number of fibers."""
        return len(self.radius)

    @property
    def segments(self) -> int:
        """Number of straight pieces of all fibers."""
        return len(self.nodes) - self.fibers

    @property
    def thickness(self) -> float:
        """Extent of the slab along the flow [m]."""
        return self.slab.size[2]

    def segment_starts(self) -> Ints:
        """Node at which each segment starts; it ends at the next node, (segments,) int array."""
        is_start = np.ones(len(self.nodes), dtype=bool)
        is_start[self.first[1:] - 1] = False
        return np.flatnonzero(is_start)

    def segment_fibers(self) -> Ints:
        """Fiber that each segment belongs to, (segments,) int array."""
        return np.repeat(np.arange(self.fibers), np.diff(self.first) - 1)

    def segment_lengths(self) -> Floats:
        """Length of each segment, (segments,) array [m]."""
        start = self.segment_starts()
        lengths: Floats = np.linalg.norm(self.nodes[start + 1] - self.nodes[start], axis=1)
        return lengths


@dataclass(frozen=True, eq=False, slots=True)
class Pieces:
    """Straight pieces of fibers, by their axes: where the true cylinders are that a surface stands for.

    Parameters
    ----------
    start, end : (n, 3) arrays [m]
        Of each axis; what ends on a side of the plan runs on beyond it.
    fiber : (n,) int array
        Fiber that each piece belongs to.
    flat : (n, 2) bool array
        Whether a piece ends flat at its start and at its end; else in half a ball, as it does at bends.
    """

    start: Floats
    end: Floats
    fiber: Ints
    flat: npt.NDArray[np.bool_]

    def __post_init__(self) -> None:
        _freeze(
            self,
            start=np.asarray(self.start, np.float64),
            end=np.asarray(self.end, np.float64),
            fiber=np.asarray(self.fiber, np.int64),
            flat=np.asarray(self.flat, np.bool_),
        )
        count = len(self.fiber)
        _check(self.start.shape == self.end.shape == (count, 3), "not every piece has a start and an end")
        _check(self.flat.shape == (count, 2), "not every piece says how it ends")
        _check(bool((self.start != self.end).any(axis=1).all()), "a piece has no length")

    def __len__(self) -> int:
        """Count the pieces."""
        return len(self.fiber)


@dataclass(frozen=True, eq=False, slots=True)
class Surface:
    """The fibers' outside, united into closed surfaces and cut flush with the plan's sides.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        Counterclockwise seen from the air.
    fiber : (m,) int array
        Fiber that each triangle came from; the flat cuts on the sides belong to their fiber too.
    radius : (fibers,) array [m]
        Radius of each fiber of the mat, as in `Mat`.
    slab : Box [m]
        The mat's slab.
    pieces : Pieces
        The fibers that the surface was built about.
    """

    points: Floats
    triangles: Ints
    fiber: Ints
    radius: Floats
    slab: Box
    pieces: Pieces

    def __post_init__(self) -> None:
        _freeze(
            self,
            points=np.asarray(self.points, np.float64),
            triangles=np.asarray(self.triangles, np.int64),
            fiber=np.asarray(self.fiber, np.int64),
            radius=np.asarray(self.radius, np.float64),
        )
        _check(len(self.triangles) > 0, "the surface has no triangle")
        _check(bool(np.isfinite(self.points).all()), "a surface point is not finite")
        _check(self.fiber.shape == (len(self.triangles),), "not every triangle names its fiber")
        _check(
            bool((self.fiber >= 0).all() and (self.fiber < len(self.radius)).all()),
            "a triangle names a fiber that the mat does not have",
        )
        open_edges = unmatched_edges(self.triangles)
        _check(open_edges == 0, f"the surface is not closed: {open_edges} edges lack their partner")
        _check(self.volume > 0, "the surface is inside out")

    @property
    def volume(self) -> float:
        """Solid volume [m3]."""
        return enclosed_volume(self.points, self.triangles)

    @property
    def solidity(self) -> float:
        """Solid volume over the slab's volume [-]."""
        return self.volume / self.slab.volume


@dataclass(frozen=True, eq=False, slots=True)
class FluidDomain:
    """The air in the duct, as a closed surface whose every triangle lies in one patch.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        Counterclockwise seen from outside the air.
    patch : (m,) int array
        Index into `patches`.
    patches : tuple of str
        ``inlet`` (lowest z), ``outlet`` (highest z), ``xmin``, ``xmax``, ``ymin``, ``ymax``, ``fibers``.
    fiber : (m,) int array
        Fiber that a triangle came from; -1 on the duct's planes.
    radius : (fibers,) array [m]
        Radius of each fiber, as in `Mat`.
    box : Box [m]
        The duct with both plenums.
    slab : Box [m]
        The mat's slab within it.
    pieces : Pieces
        The fibers that the surface was built about.
    """

    points: Floats
    triangles: Ints
    patch: Ints
    patches: tuple[str, ...]
    fiber: Ints
    radius: Floats
    box: Box
    slab: Box
    pieces: Pieces

    def __post_init__(self) -> None:
        _freeze(
            self,
            points=np.asarray(self.points, np.float64),
            triangles=np.asarray(self.triangles, np.int64),
            patch=np.asarray(self.patch, np.int64),
            fiber=np.asarray(self.fiber, np.int64),
            radius=np.asarray(self.radius, np.float64),
        )
        _check(self.patch.shape == (len(self.triangles),), "not every triangle names its patch")
        _check(self.fiber.shape == (len(self.triangles),), "not every triangle names its fiber")
        missing = sorted({*range(len(self.patches))} - set(np.unique(self.patch).tolist()))
        _check(not missing, f"no triangle in patch {', '.join(self.patches[k] for k in missing)}")
        _check(
            bool((self.patch >= 0).all() and (self.patch < len(self.patches)).all()),
            "a triangle names a patch that does not exist",
        )
        open_edges = unmatched_edges(self.triangles)
        _check(open_edges == 0, f"the duct's surface is not closed: {open_edges} edges lack their partner")
        _check(self.volume > 0, "the duct's surface is inside out")

    @property
    def volume(self) -> float:
        """Volume of the air [m3]."""
        return enclosed_volume(self.points, self.triangles)


@dataclass(frozen=True, eq=False, slots=True)
class TetMesh:
    """The air in tetrahedra.

    Parameters
    ----------
    points : (n, 3) array [m]
    tets : (m, 4) int array
        Vertices 0, 1, 2 counterclockwise seen from vertex 3's far side: every volume is above 0.
    faces : (b, 3) int array
        Boundary triangles, counterclockwise seen from outside the air.
    patch : (b,) int array
        Index into `patches` of each boundary triangle.
    patches : tuple of str
        Names; none is empty.
    slab : Box [m]
        The mat's slab within the duct.
    """

    points: Floats
    tets: Ints
    faces: Ints
    patch: Ints
    patches: tuple[str, ...]
    slab: Box

    def __post_init__(self) -> None:
        _freeze(
            self,
            points=np.asarray(self.points, np.float64),
            tets=np.asarray(self.tets, np.int64),
            faces=np.asarray(self.faces, np.int64),
            patch=np.asarray(self.patch, np.int64),
        )
        flat = np.flatnonzero(volumes(self.points, self.tets) <= 0)
        _check(
            len(flat) == 0,
            f"{len(flat)} of {len(self.tets)} tetrahedra have no positive volume, first {flat[:1].tolist()}",
        )
        _check(self.patch.shape == (len(self.faces),), "not every boundary face names its patch")
        present = set(np.unique(self.patch).tolist())
        _check(present <= set(range(len(self.patches))), "a boundary face names a patch that does not exist")
        missing = [name for k, name in enumerate(self.patches) if k not in present]
        _check(not missing, f"no boundary face in patch {', '.join(missing)}")

    @property
    def volume(self) -> float:
        """Volume of all tetrahedra [m3]."""
        return float(volumes(self.points, self.tets).sum())

    def face_mesh(self) -> "FaceMesh":
        """Give the mesh as faces between cells, in the order that a solver wants.

        Cells are renumbered by reverse Cuthill-McKee, boundary faces stand patch after patch in the order of
        `patches`, and points that no tetrahedron uses are dropped.
        """
        found = tet_faces(self.tets)
        internal = len(found.neighbour)
        patch = patch_of_faces(found.triangles[internal:], self.faces, self.patch)
        order = np.concatenate([np.arange(internal), internal + np.argsort(patch, kind="stable")])
        counts = np.bincount(patch, minlength=len(self.patches))
        starts = internal + np.cumsum(counts) - counts
        points, corners = compacted(self.points, found.triangles[order].ravel())
        return FaceMesh(
            points=points,
            corners=corners,
            offsets=np.arange(0, len(corners) + 1, 3),
            owner=found.owner[order],
            neighbour=found.neighbour,
            cells=len(self.tets),
            patches=tuple(
                Patch(name, int(start), int(count))
                for name, start, count in zip(self.patches, starts, counts, strict=True)
            ),
        )


@dataclass(frozen=True, slots=True)
class Patch:
    """A named run of boundary faces: ``faces[start:start + count]``."""

    name: str
    start: int
    count: int


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
    """

    points: Floats
    corners: Ints
    offsets: Ints
    owner: Ints
    neighbour: Ints
    cells: int
    patches: tuple[Patch, ...]

    def __post_init__(self) -> None:
        _freeze(
            self,
            points=np.asarray(self.points, np.float64),
            corners=np.asarray(self.corners, np.int64),
            offsets=np.asarray(self.offsets, np.int64),
            owner=np.asarray(self.owner, np.int64),
            neighbour=np.asarray(self.neighbour, np.int64),
        )
        _check(len(self.offsets) == len(self.owner) + 1, "offsets and owners differ in length")
        _check(self.points.ndim == 2 and self.points.shape[1] == 3, "points have three coordinates")
        _check(bool(np.isfinite(self.points).all()), "a point is not finite")
        spans = self.offsets[0] == 0 and self.offsets[-1] == len(self.corners)
        _check(bool(spans and (np.diff(self.offsets) >= 3).all()), "the offsets do not cut the corners into polygons")
        _check(_all_within(self.corners, len(self.points)), "a face has a corner that is no point")
        _check(_all_within(self.owner, self.cells), "a face has an owner that is no cell")
        _check(_all_within(self.neighbour, self.cells), "a face has a neighbour that is no cell")
        internal = len(self.neighbour)
        _check(internal <= len(self.owner), "there are more neighbours than owners")
        # a label that lies would make every array over the cells huge
        _check(
            self.cells <= len(self.owner) + internal,
            f"its labels speak of {self.cells} cells, but it has only {len(self.owner)} faces",
        )
        _check(bool((self.owner[:internal] < self.neighbour).all()), "an owner is not below its neighbour")
        end = internal
        for patch in self.patches:
            _check(patch.start == end, f"patch {patch.name} does not start where the one before ends")
            end += patch.count
        _check(end == len(self.owner), "the patches do not cover the boundary")

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
        _check(len(self.corners) == 3 * self.faces, "a face is no triangle")
        return self.corners.reshape(-1, 3)

    def tets(self) -> Ints:
        """Cells as a (cells, 4) int array of positive tetrahedra; ValueError if one is something else."""
        return tets_of_faces(self.triangles(), self.owner, self.neighbour, self.cells)

    def polyhedra(self) -> Polyhedra:
        """Areas and centers of the faces, volumes and centers of the cells."""
        return polyhedra(self.points, self.corners, self.offsets, self.owner, self.neighbour, self.cells)


@dataclass(frozen=True, slots=True)
class Metric:
    """One measure of quality over a mesh.

    Parameters
    ----------
    name, unit, source : str
        Unit ``"1"`` where it has none; `source` says whose definition and limit these are.
    where : str
        ``"cells"``, ``"faces"`` or ``"internal faces"``.
    min, mean, p99, max : float [unit]
        The mean non-orthogonality is the angle of the mean cosine, as `checkMesh` prints it.
    limit : float [unit], optional
        What a good mesh keeps to.
    worst_is : str
        ``"largest"`` or ``"smallest"``: on which side of the limit trouble lies.
    over_limit : int
        How many cells or faces break the limit.
    worst : tuple of (index, value, (x, y, z) [m])
        The worst few, worst first.
    """

    name: str
    unit: str
    where: str
    min: float
    mean: float
    p99: float
    max: float
    limit: float | None
    worst_is: str
    over_limit: int
    worst: tuple[tuple[int, float, tuple[float, float, float]], ...]
    source: str


@dataclass(frozen=True, slots=True)
class QualityReport:
    """What the mesh is like and whether it may go to a solver.

    `verdict` is ``"pass"`` where every limit holds; ``"warn"`` where what does not hold costs accuracy but stops no
    solver (non-orthogonality below 90 degrees, and what only ``checkMesh -allGeometry`` looks at: determinant, face
    weight, volume ratio); ``"fail"`` where plain `checkMesh` fails too. `reasons` has a sentence for each limit that
    does not hold. `patches` counts faces, `volume` is in m3.
    """

    cells: int
    points: int
    faces: int
    internal_faces: int
    patches: dict[str, int]
    volume: float
    metrics: dict[str, Metric]
    verdict: str
    reasons: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every limit holds."""
        return self.verdict == "pass"


@dataclass(frozen=True, slots=True)
class ModelRow:
    """Pressure drop by one model, from three solidities [Pa].

    Parameters
    ----------
    nominal, surface, mesh : float [Pa]
        From the nominal, the surface's and the mesh's solidity; infinite where the model has no answer.
    overlap, meshing : float [Pa]
        What the fibers' overlap takes (surface less nominal) and what the mesh takes (mesh less surface).
    title, structure : str
        Whose model, of what kind of medium.
    notes : tuple of str
        What is outside the model's range.
    """

    nominal: float
    surface: float
    mesh: float
    overlap: float = 0.0
    meshing: float = 0.0
    title: str = ""
    structure: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Comparison:
    """Pressure drop by analytical models from three solidities, side by side.

    Parameters
    ----------
    solidity : dict of str to float [-]
        ``nominal``, ``surface``, ``mesh``.
    thickness, fiber_diameter : float [m]
        Of the slab; the diameter of equal fibers that have the same length and volume.
    face_velocity : float [m/s]
    models : dict of str to ModelRow
    knudsen, reynolds : float [-]
        Of the fiber.
    regime : str
        Flow regime of the fiber.
    attribution : dict of str to float [-]
        Relative changes of the reference model's pressure drop: by ``overlap``, by ``meshing``, and by taking the
        lowest (``model_low``) or the highest (``model_high``) of all models instead.
    fiber_diameters : dict of str to float [m]
        Mean diameters of the mat, by what each of them keeps.
    """

    solidity: dict[str, float]
    thickness: float
    fiber_diameter: float
    face_velocity: float
    models: dict[str, ModelRow] = field(default_factory=dict)
    knudsen: float = 0.0
    reynolds: float = 0.0
    regime: str = ""
    attribution: dict[str, float] = field(default_factory=dict)
    fiber_diameters: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Flow:
    """Air on its way into the duct.

    Parameters
    ----------
    face_velocity : float [m/s]
        Flow rate over the face's area.
    temperature : float [K]
    viscosity : float [Pa s]
        Dynamic.
    density : float [kg/m3]
    mean_free_path : float [m]
    """

    face_velocity: float
    temperature: float
    viscosity: float
    density: float
    mean_free_path: float

    def __post_init__(self) -> None:
        for name in ("face_velocity", "temperature", "viscosity", "density", "mean_free_path"):
            _check(getattr(self, name) > 0, f"{name} is not above 0")


@dataclass(frozen=True, slots=True)
class Solution:
    """What a solver found for the flow through a duct.

    Parameters
    ----------
    pressure_drop : float [Pa]
        Mean over the inlet less mean over the outlet.
    flow_rate : float [m3/s]
        Into the inlet.
    drag : float [N]
        Of the air on the fibers, along the flow.
    permeability : float [m2]
        Darcy's, over the mat's thickness: viscosity x velocity x thickness / pressure drop.
    force_balance_error : float [-]
        Drag over (pressure drop x face area), less 1; the walls and the change of momentum take no part.
    mass_balance_error : float [-]
        Flow out over flow in, less 1.
    iterations : int
    converged : bool
        Whether the pressure drop had settled when the run ended.
    seconds : float [s]
        Wall time of all runs that led here.
    cores : int
    effective_fiber_diameter : float [m], optional
        Diameter for which the model the user chose gives this pressure drop at the mesh's solidity.
    f_star : float [-], optional
        For an array of parallel cylinders: drag per length of fiber over viscosity x face velocity.
    """

    pressure_drop: float
    flow_rate: float
    drag: float
    permeability: float
    force_balance_error: float
    mass_balance_error: float
    iterations: int
    converged: bool
    seconds: float
    cores: int
    effective_fiber_diameter: float | None = None
    f_star: float | None = None
