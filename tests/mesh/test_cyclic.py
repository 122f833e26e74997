"""Opposite sides of a periodic mat's lattice carry the same triangles."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest

from pipeline.analytics.settings import FlowSettings
from pipeline.case import Case, validate
from pipeline.enclosure.duct import enclose
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.formats.openfoam.cyclic import with_matching_sides
from pipeline.mat.generate import generate
from pipeline.mesh.fill import fill
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.quality.judge import judge
from pipeline.surface.union import unite
from tests.openfoam import foam


def periodic(seed: int, diameter: str = "1.4 um") -> Case:
    return validate(
        {
            "mat": {
                "generator": "layered", "side": "7 um", "fiber_diameter": diameter, "relaxation_slope": 0.15,
                "seed": seed, "periodic": True, "orientation": {"law": "isotropic"}, "stop": {"coverage": 0.8},
            },
            "enclosure": {"sides": "cyclic", "inlet": "3 um", "outlet": "3 um"},
            "tetmesh": {"engine": "lattice"},
        },
        "periodic",
    )  # fmt: skip


def meshed(case: Case) -> tuple[FluidDomain, FaceMesh]:
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    return domain, fill(domain, case.tetmesh)[0]


@pytest.mark.parametrize("seed", range(3))
def test_opposite_sides_fit_face_by_face(seed: int) -> None:
    domain, mesh = meshed(periodic(seed))
    fitting = with_matching_sides(mesh)
    triangles = fitting.triangles()
    for axis, (low, high) in enumerate((("xmin", "xmax"), ("ymin", "ymax"))):
        shift = np.zeros(3)
        shift[axis] = domain.box.size[axis]
        # the same corner first, then the opposite way round
        below = fitting.points[triangles[fitting.patch(low)]] + shift
        above = fitting.points[triangles[fitting.patch(high)]][:, [0, 2, 1]]
        np.testing.assert_allclose(above, below, rtol=0, atol=1e-6 * domain.box.size[axis])
    # beside a side whose vertices have to stay where they are, some cells may cost accuracy, but none is unusable
    assert judge(mesh).verdict in ("pass", "warn")


@pytest.mark.openfoam
def test_checkmesh_takes_the_cyclic_sides(tmp_path: Path) -> None:
    _, mesh = meshed(periodic(1))
    write_openfoam(mesh, tmp_path / "case", FlowSettings().flow(), "cyclic")
    assert "Mesh OK." in foam(tmp_path / "case", "checkMesh")
