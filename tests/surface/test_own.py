"""Surfaces of others' making: what is mended, what is refused, and that the right thing comes out."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import math
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from pipeline.case import read_case
from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.line.run import run
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.fibers import Mat
from pipeline.nouns.surface_file import SurfaceFile
from pipeline.surface.own import BodyMeasures, read_body
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite

UM = 1e-6


def crossed() -> tuple[Floats, Ints]:
    """Two crossing fibers of 1 um across a plan of 8 um x 8 um, in micrometers."""
    nodes = np.array([[0, 4, 1], [8, 4, 1], [4, 0, 1.6], [4, 8, 1.6]]) * UM
    mat = Mat(nodes, np.array([0, 2, 4]), np.full(2, 0.5 * UM), Box((0, 0, 0), (8 * UM, 8 * UM, 2.2 * UM)), -1, "two")
    surface = unite(mat, SurfaceSettings(sides=24))
    return surface.points / UM, surface.triangles


POINTS, TRIANGLES = crossed()
VOLUME = float(
    np.einsum("ij,ij->", POINTS[TRIANGLES[:, 0]], np.cross(POINTS[TRIANGLES[:, 1]], POINTS[TRIANGLES[:, 2]])) / 6
)


def read(folder: Path, points: Floats, triangles: Ints, suffix: str = ".ply", unit: float = UM) -> BodyMeasures:
    path = folder / f"body{suffix}"
    pv.PolyData.from_regular_faces(points, triangles).save(path)
    return read_body(SurfaceFile(str(path), "", unit))[1]


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj", ".vtp"])
def test_a_sound_surface_keeps_its_volume_in_every_format(suffix: str, tmp_path: Path) -> None:
    found = read(tmp_path, POINTS, TRIANGLES, suffix)
    assert found.mended == "nothing"
    # a thousandth of a diameter is taken off each flush side: 2e-3 of 8
    assert found.volume == pytest.approx(VOLUME * UM**3, rel=5e-4)
    # two cylinders: 4 V / S is their diameter, less what they share, which shortens the surface more than the volume
    assert found.mean_diameter == pytest.approx(UM, rel=0.06)


@pytest.mark.parametrize(
    ("harm", "told"),
    [
        ("flip", "turned over"),
        ("inside out", "turned over"),
        ("hole", "put into holes"),
        ("twice", "there twice"),
        ("soup", ""),
    ],
)
def test_what_can_be_mended_without_guessing_is_mended_and_told(harm: str, told: str, tmp_path: Path) -> None:
    points, triangles = POINTS, TRIANGLES
    if harm == "flip":
        triangles = np.where((np.arange(len(triangles)) % 5 == 0)[:, None], triangles[:, ::-1], triangles)
    elif harm == "inside out":
        triangles = triangles[:, ::-1]
    elif harm == "hole":
        triangles = np.delete(triangles, len(triangles) // 2, axis=0)
    elif harm == "twice":
        triangles = np.concatenate([triangles, triangles])
    else:
        points, triangles = points[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    found = read(tmp_path, points, triangles)
    assert told in found.mended
    # the surface is the same again; a hole is closed flat
    assert found.volume == pytest.approx(VOLUME * UM**3, rel=1e-3)


def test_shells_that_cut_each_other_are_united(tmp_path: Path) -> None:
    box = pv.Cube(bounds=(0, 2, 0, 2, 0, 2)).triangulate().clean()
    points, triangles = np.asarray(box.points, float), box.regular_faces
    both = np.concatenate([points, points + 1.0])
    found = read(tmp_path, both, np.concatenate([triangles, triangles + len(points)]))
    # two cubes of 8 that share 1
    assert found.volume == pytest.approx(15 * UM**3, rel=0.02)
    assert found.components == 1


def test_an_open_surface_is_refused_with_places(tmp_path: Path) -> None:
    open_one = TRIANGLES[POINTS[TRIANGLES][:, :, 0].max(axis=1) < 3]
    with pytest.raises(CaseError, match=r"is open: \d+ edges .* first at \("):
        read(tmp_path, POINTS, open_one)


def test_a_shell_that_cuts_itself_is_refused_with_places(tmp_path: Path) -> None:
    points = POINTS.copy()
    # a point of the lower fiber's top is pulled out through its bottom
    inner = (points[:, 0] > 0.5) & (points[:, 0] < 7.5) & (points[:, 1] > 3) & (points[:, 1] < 5)
    top = int(np.flatnonzero(inner)[np.argmax(points[inner, 2] - np.abs(points[inner, 0] - 2))])
    points[top] += (0.07, 0.11, -2.0)
    with pytest.raises(CaseError, match=r"cuts itself: \d+ pairs of triangles .* first at \("):
        read(tmp_path, points, TRIANGLES)


@pytest.mark.parametrize("unit", [1.0, 1e-9])
def test_the_size_tells_of_a_wrong_unit(unit: float, tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"is mat\.unit right"):
        read(tmp_path, POINTS, TRIANGLES, unit=unit)


def test_files_that_are_none_are_told_in_one_sentence(tmp_path: Path) -> None:
    for name, content in (("a.stl", b"solid nothing"), ("a.ply", b"ply\nrubbish"), ("a.step", b"ISO"), ("b.obj", b"")):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(CaseError):
            read_body(SurfaceFile(str(tmp_path / name), "", UM))
    with pytest.raises(CaseError, match="no such file"):
        read_body(SurfaceFile(str(tmp_path / "c.stl"), "", UM))


def test_the_line_takes_a_surface_from_the_duct_on(tmp_path: Path) -> None:
    pv.PolyData.from_regular_faces(POINTS, TRIANGLES).save(tmp_path / "body.stl")
    case = tmp_path / "own.toml"
    case.write_text(
        '[mat]\ngenerator = "surface"\nfile = "body.stl"\nunit = "um"\n[tetmesh]\nengine = "tetwild"\n'
        '[flow]\nface_velocity = "2.5 cm/s"\ntemperature = "293 K"\n',
        encoding="utf-8",
    )
    outcomes = run(read_case(case), tmp_path / "run", until="enclosure")
    assert [outcome.how for outcome in outcomes] == ["made"] * 3
    # the two fibers' volume over the slab's: 2 pi / 4 x 8 um3, less their crossing (below 16 / 3 r^3), over 8 x 8 x 2
    solidity = outcomes[1].counts["solidity"]
    assert isinstance(solidity, float)
    assert (4 * math.pi - 16 / 24) / (64 * 1.6) < solidity < 4 * math.pi / (64 * 1.6) * 1.01
    case.write_text(case.read_text(encoding="utf-8").replace('unit = "um"\n', ""), encoding="utf-8")
    with pytest.raises(CaseError, match="unit"):
        read_case(case)


@pytest.mark.parametrize("program", ["trimesh", "meshio"])
@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj"])
def test_files_of_other_programs_are_read_as_they_write_them(program: str, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"body{suffix}"
    if program == "trimesh":
        import trimesh

        # .stl in binary, .ply in binary, .obj in text
        trimesh.Trimesh(POINTS, TRIANGLES, process=False).export(path)
    else:
        import meshio

        # .stl and .obj in text, .ply in binary of 64 bits
        meshio.Mesh(POINTS, [("triangle", TRIANGLES)]).write(path)
    found = read_body(SurfaceFile(str(path), "", UM))[1]
    assert found.mended == "nothing"
    assert found.volume == pytest.approx(VOLUME * UM**3, rel=5e-4)


def test_the_models_take_a_body_as_a_filter(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from pipeline.cli.predicting import predict_filter

    case = tmp_path / "own.toml"
    pv.PolyData.from_regular_faces(POINTS, TRIANGLES).save(tmp_path / "body.stl")
    case.write_text(
        '[mat]\ngenerator = "surface"\nfile = "body.stl"\nunit = "um"\n'
        '[flow]\nface_velocity = "2.5 cm/s"\ntemperature = "293 K"\n',
        encoding="utf-8",
    )
    found = read_body(SurfaceFile(str(tmp_path / "body.stl"), "", UM))[1]
    predict_filter(case, {}, True, None)
    said = json.loads(capsys.readouterr().out)
    assert said["solidity"] == pytest.approx(found.solidity)
    assert said["thickness"] == pytest.approx(found.thickness)
    assert said["fiber_diameter"] == pytest.approx(found.mean_diameter)
    # after a run as before it
    run(read_case(case), tmp_path / "run", until="surface")
    predict_filter(tmp_path / "run", {}, True, None)
    assert json.loads(capsys.readouterr().out) == said
    (tmp_path / "body.stl").unlink()
    with pytest.raises(CaseError, match=r"body\.stl: there is no such file"):
        predict_filter(case, {}, True, None)


def test_a_body_catches_nothing_and_says_why(tmp_path: Path) -> None:
    from pipeline.capture.make import obstacle
    from pipeline.line.run import Run

    (tmp_path / "body.stl").write_bytes(b"")
    case = tmp_path / "own.toml"
    case.write_text(
        '[mat]\ngenerator = "surface"\nfile = "body.stl"\nunit = "um"\n'
        '[flow]\nface_velocity = "2.5 cm/s"\ntemperature = "293 K"\n',
        encoding="utf-8",
    )
    assert "need the fibers' axes" in str(obstacle(Run(read_case(case), tmp_path / "run")))
    assert obstacle(Run(read_case(Path("cases/smoke.toml")), tmp_path / "run")) is None
