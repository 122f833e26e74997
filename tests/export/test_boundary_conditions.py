"""Slip along fibers, cyclic sides and OpenFOAM.org's names."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.errors import StageError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.formats.openfoam.slip import FiberSlip, fiber_radius
from pipeline.export.settings import ExportSettings
from pipeline.openfoam.read import read_openfoam
from pipeline.solve.bed import Bed
from pipeline.solve.running import solve
from pipeline.solve.settings import OpenFoamSettings
from tests.openfoam import AIR, foam
from tests.sample_meshes import TetMesh, cylinder, duct

RADIUS = 0.7e-6


def drag_of_a_row(slip: float, folder: Path) -> float:
    """F* of a row of cylinders at solidity 0.1 per square cell; `slip` is the slip length over the radius."""
    mesh = cylinder(0.1, RADIUS, around=12, outward=12)
    depth, side = mesh.points[:, 0].max(), np.ptp(mesh.points[:, 1])
    wall = FiberSlip(slip * RADIUS, RADIUS) if slip else None
    write_openfoam(mesh, folder / "case", AIR, slip=wall)
    bed = Bed(face_area=depth * side, thickness=side, fiber_length=depth)
    found = solve(folder / "case", folder / "work", AIR, bed, OpenFoamSettings(tolerance=1e-5))
    assert abs(found.force_balance_error) < 1e-3
    assert found.f_star is not None
    return found.f_star


@pytest.mark.openfoam
def test_a_row_of_cylinders_has_its_exact_drag_and_slips_as_kuwabara_says(tmp_path: Path) -> None:
    still, slipping = (drag_of_a_row(slip, tmp_path / str(slip)) for slip in (0.0, 0.25))
    # Tamada & Fujikawa 1957, a row across the flow, t = pi r / pitch; 12 cells a side leave 1.5 %
    t = math.pi * math.sqrt(0.1 / math.pi)
    exact = 8 * math.pi / (1 - 2 * math.log(2 * t) + 2 / 3 * t**2 - t**4 / 9 + 8 / 135 * t**6)
    assert still == pytest.approx(exact, rel=0.02)
    # Kuwabara's cell with slip, the ratio of the two; a row and a cell differ by half a percent there,
    # and without the curvature term it would be 10 % off
    a, s = 0.1, 0.25
    ku = -0.5 * math.log(a) - 0.75 + a - a**2 / 4
    ratio = (1 + 2 * s) * ku / (ku + 2 * s * (-0.5 * math.log(a) - 0.25 + a**2 / 4))
    assert slipping / still == pytest.approx(ratio, rel=0.01)


def test_the_slip_fraction_is_the_wall_distance_over_its_sum_with_the_slip_length() -> None:
    mesh = duct((4, 4, 8)).face_mesh()
    flat = FiberSlip(0.3, 1e9).fractions(mesh)
    # a tetrahedron on a square of 1/4 has its center a quarter of its height above its face
    assert flat == pytest.approx(np.full(len(flat), (1 / 16) / (1 / 16 + 0.3)), rel=1e-6)
    assert FiberSlip(1e-12, 1.0).fractions(mesh) == pytest.approx(1.0)
    curved = FiberSlip(0.3, 0.3).fractions(mesh)
    assert curved == pytest.approx((1 / 16) / (1 / 16 + 0.15), rel=1e-6)


def test_the_wall_belongs_to_the_flow_and_its_old_place_says_so() -> None:
    with pytest.raises(ValueError, match=r"write flow\.fiber_wall"):
        ExportSettings.model_validate({"fiber_wall": "slip"})


def test_each_face_has_its_fiber_s_radius() -> None:
    mesh = duct((4, 4, 8)).face_mesh()
    below = mesh.polyhedra().centers[mesh.patch("fibers"), 2] < 1.0
    mesh = replace(mesh, fiber=np.where(below, 0, 1))
    assert np.array_equal(fiber_radius(mesh, np.array([0.1, 0.2])), np.where(below, 0.1, 0.2))
    assert fiber_radius(mesh, np.array([0.3, 0.3])) == 0.3


@pytest.mark.openfoam
def test_cyclic_sides_that_fit_are_one_to_the_solver(tmp_path: Path) -> None:
    mesh = duct((6, 6, 12), (10e-6, 10e-6, 20e-6), jitter=0.2).face_mesh()
    write_openfoam(mesh, tmp_path / "case", AIR, "cyclic")
    text = foam(tmp_path / "case", "checkMesh", "-allTopology")
    assert "Mesh OK." in text
    # rounding of 10 um, whatever cell a face starts from
    apart = re.search(r"Coupled point location match \(average (\S+)\) OK", text)
    assert apart is not None
    assert float(apart[1]) < 1e-20
    back = read_openfoam(tmp_path / "case")
    shape, by_name = back.polyhedra(), {patch.name: patch for patch in back.patches}
    for low, high, axis in (("xmin", "xmax", 0), ("ymin", "ymax", 1)):
        a, b = (slice(by_name[name].start, by_name[name].start + by_name[name].count) for name in (low, high))
        shift = shape.centers[b] - shape.centers[a]
        assert shift == pytest.approx(np.tile(np.eye(3)[axis] * 10e-6, (len(shift), 1)), abs=1e-12)
        assert shape.areas[b] == pytest.approx(-shape.areas[a], abs=1e-20)
    found = solve(tmp_path / "case", tmp_path / "work", AIR, Bed(1e-10, 10e-6))
    assert found.converged
    assert abs(found.mass_balance_error) < 1e-5
    assert abs(found.force_balance_error) < 0.01


def test_cyclic_sides_that_do_not_fit_are_refused_with_the_count(tmp_path: Path) -> None:
    tets = duct((4, 4, 8), hole=False)
    points = tets.points.copy()
    middle = np.flatnonzero((points[:, 0] == 1.0) & (points[:, 1] == 0.5) & (points[:, 2] == 1.0))
    points[middle, 1] += 0.01
    mesh = TetMesh(points, tets.tets, tets.faces, tets.patch, tets.patches, tets.slab).face_mesh()
    # six triangles meet in the point that was moved
    with pytest.raises(StageError, match=r"xmin and xmax, which do not fit: 6 of 64 triangles of xmin"):
        write_openfoam(mesh, tmp_path / "case", AIR, "cyclic")
    assert not (tmp_path / "case").exists()


def test_openfoam_org_gets_its_own_names(tmp_path: Path) -> None:
    mesh = duct().face_mesh()
    for dialect in ("com", "org"):
        write_openfoam(mesh, tmp_path / dialect, AIR, settings=ExportSettings.model_validate({"dialect": dialect}))
    files = {
        dialect: {path.name for path in (tmp_path / dialect / "constant").iterdir() if path.is_file()}
        for dialect in ("com", "org")
    }
    assert files == {
        "com": {"transportProperties", "turbulenceProperties"},
        "org": {"physicalProperties", "momentumTransport"},
    }
    control = (tmp_path / "org/system/controlDict").read_text()
    assert "application     foamRun;" in control
    assert "solver          incompressibleFluid;" in control
    assert "stopAtFile;" in control
    assert "simpleFoam" not in (tmp_path / "org/Allrun").read_text()
