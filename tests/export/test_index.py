"""The index of a run's VTK files names the flow where there is one of this mesh, and opens with it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import pyvista as pv

from pipeline.case import read_case
from pipeline.export.formats.vtk import write_vtk
from pipeline.export.formats.vtk_index import INDEX
from pipeline.export.index import name_flow
from pipeline.export.stage import EXPORT
from pipeline.line.manifest import damaged, read_manifest, write_manifest
from pipeline.line.results import Results
from pipeline.line.stages import LINE
from pipeline.nouns.flow_field import FLOW_FILE
from tests.sample_meshes import duct

SMOKE = Path(__file__).parents[2] / "cases" / "smoke.toml"


def closed(stage: Path, records: tuple[str, ...] = ()) -> None:
    """Close a stage's folder with a manifest."""
    tables: dict[str, object] = {
        name: {} for name in ("parameters", "sources", "inputs", "code", "libraries", "counts")
    }
    rest = {"stage": stage.name, "key": "some", "why": [], "seconds": 1.0, "peak_memory": 1}
    write_manifest(stage, {**tables, **rest}, records)


def exported(folder: Path) -> Path:
    write_vtk(duct().face_mesh(), folder / "export" / "vtk", {})
    closed(folder / "export", EXPORT.records)
    return folder / "export" / "vtk" / INDEX


def solved(folder: Path) -> None:
    (folder / "solve").mkdir()
    grid = pv.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    grid.point_data["velocity"] = grid.points
    grid.save(folder / "solve" / FLOW_FILE)
    closed(folder / "solve")


def results(folder: Path, left_out: tuple[str, ...] = ()) -> Results:
    return Results(read_case(SMOKE), folder, LINE, left_out)


def test_the_flow_is_a_block_once_it_is_there_and_none_once_it_is_of_another_mesh(tmp_path: Path) -> None:
    index = exported(tmp_path)
    name_flow(results(tmp_path))
    assert pv.read(index).keys() == ["internal", "boundary"]
    solved(tmp_path)
    name_flow(results(tmp_path))
    blocks = pv.read(index)
    assert blocks.keys() == ["internal", "boundary", "flow"]
    assert "velocity" in blocks["flow"].point_data
    assert len(blocks["boundary"].keys()) == 7
    # the flow is no part of what export made: its own files are as it left them
    manifest = read_manifest(tmp_path / "export")
    assert manifest is not None
    assert damaged(tmp_path / "export", manifest) == []
    # made of another mesh, or half gone
    name_flow(results(tmp_path, ("solve",)))
    assert pv.read(index).keys() == ["internal", "boundary"]
    name_flow(results(tmp_path))
    (tmp_path / "solve" / FLOW_FILE).unlink()
    name_flow(results(tmp_path))
    assert pv.read(index).keys() == ["internal", "boundary"]


def test_an_index_that_is_right_is_left_alone_and_one_that_is_not_is_mended(tmp_path: Path) -> None:
    index = exported(tmp_path / "run")
    solved(tmp_path / "run")
    name_flow(results(tmp_path / "run"))
    text, before = index.read_text(), index.stat().st_ino
    name_flow(results(tmp_path / "run"))
    assert index.stat().st_ino == before
    elsewhere = tmp_path / "elsewhere"
    elsewhere.write_text("of somebody else")
    index.unlink()
    index.symlink_to(elsewhere)
    name_flow(results(tmp_path / "run"))
    assert not index.is_symlink()
    assert elsewhere.read_text() == "of somebody else"
    assert index.read_text() == text
    index.write_bytes(b"\xff\xfe")
    name_flow(results(tmp_path / "run"))
    assert index.read_text() == text


def test_a_run_without_files_for_vtk_gets_no_index(tmp_path: Path) -> None:
    name_flow(results(tmp_path))
    assert not (tmp_path / "export").exists()
    (tmp_path / "export" / "openfoam").mkdir(parents=True)
    (tmp_path / "export" / "openfoam" / "Allrun").write_text("#!/bin/sh")
    closed(tmp_path / "export")
    name_flow(results(tmp_path))
    assert not (tmp_path / "export" / "vtk").exists()
