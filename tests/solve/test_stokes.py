"""Creeping flow by second-order elements, against exact drags and laws of force and mass."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import math

import numpy as np
import pytest

from pipeline.errors import StageError
from pipeline.mesh.wall_fibers import wall_fibers
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.flow import Flow, Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import silent
from pipeline.solve.bed import Bed
from pipeline.solve.settings import StokesSettings
from pipeline.solve.stokes.solver import solve_stokes
from tests.openfoam import AIR
from tests.sample_meshes import TetMesh, boundary_of, cylinder
from tests.solve.rows import rows
from validation.exact import square_drag


def solved(
    mesh: FaceMesh | TetMesh,
    domain: FluidDomain,
    slip: float = 0.1,
    wall: str = "no_slip",
    sides: str = "symmetry",
    flow: Flow = AIR,
    settings: StokesSettings | None = None,
) -> tuple[Solution, FlowField]:
    """Solve with a slip length of `slip` radii."""
    radius = float(domain.radius.mean())
    flow = dataclasses.replace(flow, mean_free_path=slip * radius / 0.998)
    bed = Bed(domain.slab.face_area, domain.slab.size[2])
    faces = mesh.face_mesh() if isinstance(mesh, TetMesh) else mesh
    faces = dataclasses.replace(faces, fiber=wall_fibers(faces, domain))
    found = solve_stokes(faces, domain, flow, bed, 0.1, wall, sides, settings or StokesSettings(), silent)
    return found[0], found[1]


def f_star(solution: Solution, domain: FluidDomain, fiber: int, flow: Flow = AIR) -> float:
    """Drag of one fiber per length over viscosity and velocity."""
    return solution.drag_per_fiber[fiber] / (domain.box.size[0] * flow.viscosity * flow.face_velocity)


def row_drag(solidity: float) -> float:
    """F* of one row of cylinders across the flow (Tamada & Fujikawa 1957), t = pi r / pitch."""
    t = math.pi * math.sqrt(solidity / math.pi)
    return 8 * math.pi / (1 - 2 * math.log(2 * t) + 2 / 3 * t**2 - t**4 / 9 + 8 / 135 * t**6)


def test_the_drag_of_a_row_converges_to_its_exact_value_at_third_order_or_better() -> None:
    # the series of Tamada & Fujikawa is itself right to 1e-4 at this solidity
    errors = []
    for cells in (4, 8):
        mesh, domain = rows(0.02, around=cells, outward=cells)
        errors.append(f_star(solved(mesh, domain)[0], domain, 0) / row_drag(0.02) - 1)
    assert abs(errors[1]) < 1e-3
    assert abs(errors[0]) > 4 * abs(errors[1])


@pytest.mark.parametrize("slip", [0.1, 1.0])
def test_the_middle_of_three_rows_has_the_drag_of_the_endless_array_with_and_without_slip(slip: float) -> None:
    mesh, domain = rows(0.1, count=3, around=6, outward=6)
    still, _ = solved(mesh, domain, slip, "no_slip")
    slipping, _ = solved(mesh, domain, slip, "slip")
    # 6 cells a side of the square about a cylinder leave .2 %
    assert f_star(still, domain, 1) == pytest.approx(square_drag(0.1), rel=4e-3)
    assert f_star(slipping, domain, 1) == pytest.approx(square_drag(0.1, slip), rel=4e-3)
    # each solution tells the drop with the other wall
    assert still.pressure_drop_slip == pytest.approx(slipping.pressure_drop, rel=1e-4)
    assert slipping.pressure_drop_no_slip == pytest.approx(still.pressure_drop, rel=1e-4)
    assert slipping.pressure_drop_slip == slipping.pressure_drop


@pytest.mark.parametrize("wall", ["slip", "no_slip"])
def test_forces_and_mass_balance(wall: str) -> None:
    mesh, domain = rows(0.2, count=2, around=5, outward=4)
    solution, field = solved(mesh, domain, wall=wall)
    # nothing but the fibers holds the air back, to what the iterations leave
    assert sum(solution.drag_per_fiber) == pytest.approx(solution.drag)
    assert abs(solution.force_balance_error) < 1e-6
    assert abs(solution.mass_balance_error) < 2e-5
    assert solution.converged
    assert solution.pressure_drop_error is not None
    assert solution.pressure_drop_error < 1e-4
    # the pressure before the mat is the pressure drop: the field and the forces speak of one flow
    before = field.pressure[field.positions[: len(field.pressure), 2] < domain.box.lower[2] + 1e-9]
    assert before.mean() == pytest.approx(solution.pressure_drop, rel=5e-3)


def test_opposite_sides_that_are_one_give_the_flow_between_planes_where_that_is_symmetric() -> None:
    mesh, domain = rows(0.1, around=4, outward=4)
    planes, _ = solved(mesh, domain, wall="slip")
    wrapped, field = solved(mesh, domain, wall="slip", sides="cyclic")
    # the same flow on the same mesh: what differs is where its error is free to go
    assert wrapped.pressure_drop == pytest.approx(planes.pressure_drop, rel=2e-3)
    low = np.isclose(field.positions[:, 1], domain.box.lower[1], atol=1e-12)
    high = np.isclose(field.positions[:, 1], domain.box.upper[1], atol=1e-12)
    assert np.sort(field.velocity[low, 2]) == pytest.approx(np.sort(field.velocity[high, 2]), abs=1e-12)


def test_walls_are_on_the_true_fibers_and_the_flow_along_them() -> None:
    mesh, domain = rows(0.1, around=4, outward=4)
    solution, field = solved(mesh, domain, wall="slip")
    off = np.hypot(field.positions[:, 1], field.positions[:, 2]) - domain.radius[0]
    wall = np.abs(off) < 1e-6 * domain.radius[0]
    # 16 vertices and 16 arcs on two ends, their axial edges and the diagonals between them
    assert wall.sum() == 16 * 2 + 16 * 2 + 16 + 16
    assert solution.straight_wall_edges == 0
    assert solution.wall_edges == 16 * 4
    assert field.curved.any()
    outward = field.positions[wall] * [0.0, 1.0, 1.0] / domain.radius[0]
    through = np.einsum("ij,ij->i", field.velocity[wall], outward)
    assert np.abs(through).max() < 1e-6 * np.linalg.norm(field.velocity[wall], axis=1).max()


def test_the_field_is_read_at_any_place_of_a_cell() -> None:
    mesh, domain = rows(0.1, around=4, outward=4)
    _, field = solved(mesh, domain)
    cell = np.arange(len(field.cells))
    for corner in range(4):
        at = np.zeros((len(cell), 4))
        at[:, corner] = 1.0
        assert np.array_equal(field.place(cell, at), field.positions[field.cells[:, corner]])
        assert np.array_equal(field.velocity_at(cell, at), field.velocity[field.cells[:, corner]])
        assert np.array_equal(field.pressure_at(cell, at), field.pressure[field.cells[:, corner]])
    middle = np.full((len(cell), 4), 0.25)
    # far from the fiber the velocity is the face's
    far = field.positions[field.cells].min(axis=1)[:, 2] > domain.box.upper[2] - 0.3 * domain.box.size[1]
    assert field.velocity_at(cell, middle)[far].mean(axis=0) == pytest.approx([0, 0, AIR.face_velocity], abs=2e-4)


def pocket(mesh: TetMesh) -> TetMesh:
    """Add a tetrahedron that touches nothing, with walls all round."""
    corners = mesh.points.max(axis=0) * 1.5 + 1e-7 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    number = len(mesh.points) + np.arange(4)
    faces = number[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    return TetMesh(
        np.concatenate([mesh.points, corners]),
        np.concatenate([mesh.tets, number[None]]),
        np.concatenate([mesh.faces, faces]),
        np.concatenate([mesh.patch, np.full(4, mesh.patches.index("fibers"))]),
        mesh.patches,
        mesh.slab,
    )


def plenums(mesh: TetMesh, domain: FluidDomain) -> TetMesh:
    """Give the air before and behind a row alone."""
    low = mesh.points[mesh.tets][:, :, 2].max(axis=1) <= -0.5 * domain.box.size[1] + 1e-12
    high = mesh.points[mesh.tets][:, :, 2].min(axis=1) >= 0.5 * domain.box.size[1] - 1e-12
    used, tets = np.unique(mesh.tets[low | high], return_inverse=True)
    points, tets = mesh.points[used], tets.reshape(-1, 4)
    faces = boundary_of(tets)
    patch = np.full(len(faces), mesh.patches.index("fibers"))
    for name, axis, value in (
        ("inlet", 2, domain.box.lower[2]), ("outlet", 2, domain.box.upper[2]), ("xmin", 0, domain.box.lower[0]),
        ("xmax", 0, domain.box.upper[0]), ("ymin", 1, domain.box.lower[1]), ("ymax", 1, domain.box.upper[1]),
    ):  # fmt: skip
        patch[np.isclose(points[faces][:, :, axis], value, rtol=0, atol=1e-15).all(axis=1)] = mesh.patches.index(name)
    return TetMesh(points, tets, faces, patch, mesh.patches, mesh.slab)


def test_air_that_cannot_flow_is_refused_with_the_place() -> None:
    mesh, domain = rows(0.1, around=4, outward=4)
    with pytest.raises(StageError, match=r"1 pockets of 1 tetrahedra .* are cut off, the first at \("):
        solved(pocket(mesh), domain)
    closed = plenums(mesh, domain)
    with pytest.raises(StageError, match="close the duct"):
        solved(closed, domain)
    faces_mesh = mesh.face_mesh()
    nameless = dataclasses.replace(
        faces_mesh,
        patches=tuple(
            dataclasses.replace(p, name="exit" if p.name == "outlet" else p.name) for p in faces_mesh.patches
        ),
    )
    with pytest.raises(StageError, match="no outlet"):
        solved(nameless, domain)


def test_cells_inside_out_are_refused_with_the_place() -> None:
    mesh, domain = rows(0.1, around=4, outward=4)
    faces = mesh.face_mesh()
    points = faces.points.copy()
    points[np.argmax(points[:, 2]), 2] = domain.box.lower[2] - 5e-6
    with pytest.raises(StageError, match=r"inside out, first \d+ at \("):
        solved(dataclasses.replace(faces, points=points), domain)


def test_what_the_elements_cannot_solve_is_refused_with_the_reason() -> None:
    mesh, domain = rows(0.1, around=4, outward=4)
    with pytest.raises(StageError, match=r"beyond the gap .* transition"):
        solved(mesh, domain, slip=6.0, wall="slip")
    with pytest.raises(StageError, match=r"takes about .* GB, and .* may be used"):
        solved(mesh, domain, settings=StokesSettings(memory_limit=1e6))
    with pytest.raises(StageError, match="other cells"):
        solved(cylinder(0.1, 0.5e-6), domain)


def test_a_flow_that_ran_out_of_iterations_says_so() -> None:
    mesh, domain = rows(0.1, around=4, outward=4)
    solution, _ = solved(mesh, domain, settings=StokesSettings(max_iterations=3))
    assert not solution.converged
    assert solution.iterations == 3
