"""`fibertwin tiles`: processes that know nothing of each other make one case that OpenFOAM takes as it is."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path

import numpy as np
import pytest

from pipeline.cli.app import app
from pipeline.errors import CaseError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.line.run import Run, run
from pipeline.mesh.tiles.plan import TilePlan
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.tiled import RESULT
from pipeline.openfoam.process import call
from pipeline.openfoam.read import read_openfoam
from pipeline.solve.read_back import PRESSURE_IN, history
from pipeline.tiles.make import FOLDER, flowing
from pipeline.tiles.work import CASE, Made
from tests.openfoam import foam

MAT = """
[mat]
generator = "layered"
side = "26 um"
fiber_diameter = "1.4 um"
relaxation_slope = 0.15
seed = 1
stop = { coverage = 0.3 }

[enclosure]
inlet = "3 um"
outlet = "3 um"

[tetmesh]
engine = "lattice"
edge = 1.0
largest_edge = 2.0
deviation = 1.0

[flow]
fiber_wall = "no_slip"
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run with its tiles."""
    place = tmp_path_factory.mktemp("tiles")
    (place / "case.toml").write_text(MAT, encoding="utf-8")
    arguments = ["tiles", str(place / "case.toml"), "--tiles", "2x2", "--workers", "1", "--out", str(place / "run")]
    app([*arguments, "--quiet"], exit_on_error=False, result_action="return_value")
    return place / "run"


@pytest.mark.slow
class TestACaseInTiles:
    def test_each_process_has_a_folder_and_what_is_told_of_it(self, made: Path) -> None:
        told = json.loads((made / FOLDER / RESULT).read_text(encoding="utf-8"))
        assert told["verdict"] == "pass"
        assert told["counts"] == [2, 2]
        assert told["cut_off_cells"] == 0
        assert abs(told["volume_error"]) < 0.02
        for number, tile in enumerate(told["tiles"]):
            mesh = read_openfoam(made / FOLDER / CASE / f"processor{number}")
            assert (mesh.cells, len(mesh.points)) == (tile["cells"], tile["points"])
            assert mesh.volume == pytest.approx(tile["volume"], rel=1e-12)
        # the pieces are gone: they are as large as the case
        assert sorted(path.name for path in (made / FOLDER).iterdir()) == [CASE, RESULT]

    @pytest.mark.openfoam
    def test_checkmesh_takes_all_tiles_together(self, made: Path) -> None:
        case = made / FOLDER / CASE
        call(["mpirun", "-np", "4", "checkMesh", "-parallel", "-allTopology"], case)
        text = (case / "log.mpirun").read_text(encoding="utf-8")
        assert "Mesh OK." in text
        assert "Number of regions: 1 (OK)." in text
        assert "Coupled point location match (average 0) OK." in text
        told = json.loads((made / FOLDER / RESULT).read_text(encoding="utf-8"))
        assert f"cells:            {told['cells']}\n" in text

    @pytest.mark.openfoam
    @pytest.mark.timeout(1200)
    def test_the_pressure_drop_is_that_of_the_mesh_in_one_piece(self, made: Path, tmp_path: Path) -> None:
        results = Run.opened(made)
        run(results.case, made, "tetmesh")
        flow = results.case.flow.flow()
        write_openfoam(results.read(FaceMesh), tmp_path / "whole", flow)
        tiles = made / FOLDER / CASE
        for case in (tmp_path / "whole", tiles):
            control = case / "system/controlDict"
            # as many iterations for both: they end when residuals are small, which processes sum in another order
            text = control.read_text(encoding="ascii").replace("endTime         2000;", "endTime         30;")
            control.write_text(text, encoding="ascii")
        foam(tmp_path / "whole", "simpleFoam")
        call(["mpirun", "-np", "4", "simpleFoam", "-parallel"], tiles)
        whole, parallel = (history(case, PRESSURE_IN)[-1, 1] for case in (tmp_path / "whole", tiles))
        assert parallel == pytest.approx(whole, rel=0.01)


def test_pockets_that_no_way_leads_to_are_found_across_tiles() -> None:
    # two tiles of three and two parts: 0a - 1a from the inlet, 0b - 1b a pocket that lies in both, 0c by itself
    cut = TilePlan((0.5,), (), 0.1, 0.1, (0.0, 0.0), (1.0, 1.0))
    one = Made(1, 60, np.array([40, 15, 5]), np.array([True, False, False]), {1: np.array([0, 1, 0])}, 0.0, 0)
    two = Made(2, 50, np.array([20, 30]), np.array([False, False]), {0: np.array([1, 0, 1])}, 0.0, 0)
    kept, lost = flowing([one, two], cut)
    assert [each.tolist() for each in kept] == [[True, False, False], [False, True]]
    assert lost == 15 + 5 + 20


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (["--set", "tetmesh.engine=tetwild"], 'need tetmesh.engine = "lattice"'),
        (["--set", "mat.periodic=true", "--set", "enclosure.sides=cyclic"], "cyclic sides are not cut"),
        (["--tiles", "4"], "like 2x2"),
        (["--tiles", "0x2"], "like 2x2"),
        (["--workers", "0"], "one or more"),
    ],
)
def test_nonsense_is_refused_before_anything_is_made(tmp_path: Path, wrong: list[str], words: str) -> None:
    (tmp_path / "case.toml").write_text(MAT, encoding="utf-8")
    with pytest.raises(CaseError, match=words):
        app(["tiles", str(tmp_path / "case.toml"), "--out", str(tmp_path / "run"), *wrong], exit_on_error=False)
    assert not (tmp_path / "run").exists()
