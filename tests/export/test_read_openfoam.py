"""Meshes from strangers: each damage is one clear error, never a crash."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pipeline.errors import StageError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.settings import ExportSettings
from pipeline.openfoam.foam_file import Encoding
from pipeline.openfoam.read import read_openfoam
from tests.openfoam import AIR
from tests.sample_meshes import duct

FILES = ("points", "faces", "owner", "neighbour", "boundary")


@pytest.fixture(scope="module", params=["binary", "ascii"])
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    encoding: Encoding = request.param
    folder = tmp_path_factory.mktemp(encoding)
    write_openfoam(duct().face_mesh(), folder, AIR, settings=ExportSettings(encoding=encoding))
    return folder


@pytest.mark.parametrize("name", FILES)
def test_a_missing_file_is_named(case: Path, name: str) -> None:
    path = case / "constant/polyMesh" / name
    content = path.read_bytes()
    path.unlink()
    try:
        with pytest.raises(StageError, match=name):
            read_openfoam(case)
    finally:
        path.write_bytes(content)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(name=st.sampled_from(FILES), at=st.floats(0, 1), junk=st.binary(max_size=12), cut=st.booleans())
def test_a_damaged_file_is_an_error_or_still_a_mesh(case: Path, name: str, at: float, junk: bytes, cut: bool) -> None:
    path = case / "constant/polyMesh" / name
    content = path.read_bytes()
    place = int(at * len(content))
    path.write_bytes(content[:place] + junk + (b"" if cut else content[place + len(junk) :]))
    try:
        # a changed coordinate may leave a valid mesh; anything but a StageError would end the test
        with contextlib.suppress(StageError):
            assert read_openfoam(case).cells > 0
    finally:
        path.write_bytes(content)


def test_a_compressed_mesh_says_what_to_do(tmp_path: Path) -> None:
    folder = tmp_path / "constant/polyMesh"
    folder.mkdir(parents=True)
    (folder / "points.gz").write_bytes(b"")
    with pytest.raises(StageError, match="gunzip"):
        read_openfoam(tmp_path)
