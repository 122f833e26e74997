"""The README of a written case tells what its pressures are and what finite volumes leave on its mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from pathlib import Path

import pytest

from pipeline.analytics.measured_errors import mesh_error
from pipeline.export.formats.format import Order
from pipeline.export.formats.openfoam.format import FORMAT
from pipeline.export.formats.openfoam.readme import format_readme
from pipeline.export.settings import ExportSettings
from tests.openfoam import AIR
from tests.sample_meshes import duct


def test_the_default_mesh_has_its_error_and_what_five_two_and_one_percent_need() -> None:
    text = format_readme(1.2, True, "tetwild", 0.6)
    known = mesh_error("tetwild", "openfoam", 0.6)
    assert known is not None
    assert f"simpleFoam's pressure drop was {100 * known.mean:+.1f} % off" in text
    edges = [float(edge) for edge in re.findall(r"% need `tetmesh.edge = ([\d.]+)`", text)]
    assert len(edges) == 3
    assert edges == sorted(edges, reverse=True)
    assert "not Pa" in text
    assert "The air slips along the fibers." in text


@pytest.mark.parametrize(("mesher", "edge"), [(None, None), ("tetwild", 0.05)])
def test_a_mesh_that_was_not_measured_is_told_so(mesher: str | None, edge: float | None) -> None:
    text = format_readme(1.2, False, mesher, edge)
    assert "not known" in text or "was not measured" in text
    assert "stands still" in text


def test_the_readme_stands_beside_the_scripts(tmp_path: Path) -> None:
    assert FORMAT.write is not None
    mesh = duct((2, 2, 4), (1e-5, 1e-5, 2e-5)).face_mesh()
    FORMAT.write(mesh, tmp_path, Order(ExportSettings(), AIR, "symmetry", mesher="lattice", edge=0.6))
    text = (tmp_path / "README.md").read_text(encoding="ascii")
    assert "tetmesh.engine = lattice" in text
    assert (tmp_path / "Allrun").is_file()
