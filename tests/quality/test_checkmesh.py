"""Agreement with OpenFOAM's own `checkMesh`, on tetrahedra, polyhedra and hexahedra with hanging nodes."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
import shutil
from pathlib import Path

import pytest

from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.read import read_mesh
from pipeline.nouns.mesh import FaceMesh
from pipeline.openfoam.read import read_openfoam
from pipeline.quality.judge import judge
from pipeline.quality.kinds import cells_by_kind
from tests.openfoam import AIR, figures, foam, patches
from tests.sample_meshes import duct

pytestmark = pytest.mark.openfoam

SNAPPY = """
FoamFile { version 2.0; format ascii; class dictionary; object snappyHexMeshDict; }
castellatedMesh true; snap true; addLayers false;
geometry { ball { type searchableSphere; centre (0.5e-5 0.5e-5 1e-5); radius 0.26e-5; } }
castellatedMeshControls
{
    maxLocalCells 100000; maxGlobalCells 100000; minRefinementCells 0; nCellsBetweenLevels 1;
    features (); refinementSurfaces { ball { level (1 1); } } resolveFeatureAngle 30;
    refinementRegions {} locationInMesh (1.1e-6 1.1e-6 1.1e-6); allowFreeStandingZoneFaces false;
}
snapControls { nSmoothPatch 3; tolerance 2; nSolveIter 30; nRelaxIter 5; }
addLayersControls { relativeSizes true; layers {} expansionRatio 1; finalLayerThickness 0.3; minThickness 0.1; nGrow 0;
    featureAngle 60; nRelaxIter 3; nSmoothSurfaceNormals 1; nSmoothNormals 3; nSmoothThickness 10;
    maxFaceThicknessRatio 0.5; maxThicknessToMedialRatio 0.3; minMedianAxisAngle 90; nBufferCellsNoExtrude 0;
    nLayerIter 50; }
meshQualityControls { maxNonOrtho 65; maxBoundarySkewness 20; maxInternalSkewness 4; maxConcave 80; minVol 1e-30;
    minTetQuality 1e-30; minArea -1; minTwist 0.02; minDeterminant 0.001; minFaceWeight 0.02; minVolRatio 0.01;
    minTriangleTwist -1; nSmoothScale 4; errorReduction 0.75; }
mergeTolerance 1e-6;
"""
BLOCK = """
FoamFile { version 2.0; format ascii; class dictionary; object blockMeshDict; }
scale 1e-5;
vertices ((0 0 0) (1 0 0) (1 1 0) (0 1 0) (0 0 2) (1 0 2) (1 1 2) (0 1 2));
blocks (hex (0 1 2 3 4 5 6 7) (8 8 16) simpleGrading (1 2 1));
edges ();
boundary ( inlet { type patch; faces ((0 3 2 1)); } outlet { type patch; faces ((4 5 6 7)); }
    walls { type wall; faces ((0 1 5 4) (1 2 6 5) (2 3 7 6) (3 0 4 7)); } );
"""


def assert_as_checkmesh_says(case: Path, mesh: FaceMesh, *, cells_of_kind: str) -> None:
    text = foam(case, "checkMesh", "-allGeometry", "-allTopology", "-latestTime")
    said, report = figures(text), judge(mesh)
    assert f"    {cells_of_kind}:     0\n" not in text
    assert len(said) == 16
    assert report.volume == pytest.approx(said.pop("total_volume"), rel=1e-6)
    # both measure rounding
    assert max(said.pop("max_openness"), report.metrics["openness"].max) < 1e-14
    for name, value in said.items():
        which, metric = name.split("_", 1)
        ours = getattr(report.metrics[metric], which)
        # 5 digits of what it prints; angles and ratios of nothing are rounding
        floor = 0.0 if metric in ("volume", "face_area") else 1e-10
        assert ours == pytest.approx(value, rel=1e-5, abs=floor), name
    assert {patch.name: patch.count for patch in mesh.patches} == patches(text)
    above = (
        int(text.split("severely non-orthogonal (> 70 degrees) faces:")[1].split(".")[0]) if "severely" in text else 0
    )
    assert report.metrics["non_orthogonality"].over_limit == above
    # what only -allGeometry looks at: the sets that it writes hold each cell or face once
    for metric, words in (("concavity", "concave cells"), ("face_tets", "faces with low quality")):
        written = re.search(rf"<<Writing (\d+) {words}", text)
        assert report.metrics[metric].over_limit == (int(written[1]) if written else 0), metric
    kinds = dict(re.findall(r"^    (hexahedra|prisms|pyramids|tetrahedra|polyhedra): +(\d+)$", text, re.MULTILINE))
    assert len(kinds) == 5
    assert cells_by_kind(mesh) == {kind: int(count) for kind, count in kinds.items() if int(count)}


@pytest.fixture
def tets(tmp_path: Path) -> tuple[Path, FaceMesh]:
    mesh = duct((5, 5, 10), (10e-6, 10e-6, 20e-6), jitter=0.24).face_mesh()
    write_openfoam(mesh, tmp_path, AIR)
    return tmp_path, mesh


def test_tetrahedra_agree_to_five_digits(tets: tuple[Path, FaceMesh]) -> None:
    assert_as_checkmesh_says(*tets, cells_of_kind="tetrahedra")


def test_polyhedra_of_polydualmesh_agree_to_five_digits(tets: tuple[Path, FaceMesh]) -> None:
    case, _ = tets
    foam(case, "polyDualMesh", "-overwrite", "75")
    # polyDualMesh moves corners off the sides by rounding, which symmetryPlane does not take
    boundary = case / "constant/polyMesh/boundary"
    boundary.write_text(boundary.read_text().replace("symmetryPlane", "symmetry"))
    assert_as_checkmesh_says(case, read_openfoam(case), cells_of_kind="polyhedra")


def test_hanging_nodes_of_snappyhexmesh_agree_to_five_digits(tets: tuple[Path, FaceMesh]) -> None:
    case, _ = tets
    (case / "system/blockMeshDict").write_text(BLOCK)
    (case / "system/snappyHexMeshDict").write_text(SNAPPY)
    foam(case, "blockMesh")
    assert_as_checkmesh_says(case, read_openfoam(case), cells_of_kind="hexahedra")
    foam(case, "snappyHexMesh", "-overwrite")
    assert_as_checkmesh_says(case, read_openfoam(case), cells_of_kind="polyhedra")


def test_meshes_that_openfoam_wrote_for_others_are_the_same_mesh(tets: tuple[Path, FaceMesh]) -> None:
    case, _ = tets
    (case / "system/blockMeshDict").write_text(BLOCK)
    (case / "system/snappyHexMeshDict").write_text(SNAPPY)
    foam(case, "blockMesh")
    foam(case, "snappyHexMesh", "-overwrite")
    # the fields of the mesh before have no place on this one
    shutil.rmtree(case / "0")
    foam(case, "foamToVTK")
    foam(case, "foamMeshToFluent")
    ours = judge(read_mesh(case))
    written = next(case.glob("VTK/*/internal.vtu")), next(case.glob("fluentInterface/*.msh"))
    for path in written:
        mesh = read_mesh(path)
        theirs = judge(mesh)
        # hexahedra, prisms and polyhedra in one file, numbered otherwise; VTK's has points of 32 bits
        assert cells_by_kind(mesh) == cells_by_kind(read_mesh(case))
        assert (theirs.cells, theirs.faces, theirs.internal_faces) == (ours.cells, ours.faces, ours.internal_faces)
        assert theirs.volume == pytest.approx(ours.volume, rel=1e-5)
        for name, metric in ours.metrics.items():
            if name != "openness":
                assert theirs.metrics[name].mean == pytest.approx(metric.mean, rel=2e-4, abs=1e-6), name


FLAT = """
FoamFile { version 2.0; format ascii; class dictionary; object blockMeshDict; }
vertices ((0 0 0) (1 0 0) (1.3 1 0) (0.1 1 0) (0 0 0.1) (1 0 0.1) (1.3 1 0.1) (0.1 1 0.1));
blocks (hex (0 1 2 3 4 5 6 7) (CELLS) simpleGrading (2 3 1));
edges ();
boundary ( lid { type wall; faces ((3 7 6 2)); } floor { type wall; faces ((1 5 4 0)); }
    ends { type ENDS; faces ((0 4 7 3) (2 6 5 1)); } frontAndBack { type empty; faces ((0 3 2 1) (4 5 6 7)); } );
"""
WEDGE = """
FoamFile { version 2.0; format ascii; class dictionary; object blockMeshDict; }
vertices ((0 0 0) (1 0 0) (1 0.999048 -0.0436194) (0 0.999048 -0.0436194)
    (1 0.999048 0.0436194) (0 0.999048 0.0436194));
blocks (hex (0 1 2 3 0 1 4 5) (7 9 1) simpleGrading (1 2 1));
edges ();
boundary ( left { type patch; faces ((0 3 5 0)); } right { type patch; faces ((1 4 2 1)); }
    rim { type wall; faces ((2 4 5 3)); } front { type wedge; faces ((0 1 4 5)); }
    back { type wedge; faces ((0 3 2 1)); } axis { type empty; faces ((0 1 1 0)); } );
"""


@pytest.mark.parametrize(
    "block",
    [
        FLAT.replace("CELLS", "8 6 1").replace("ENDS", "wall"),
        # one row of cells between two pairs of empty patches: a mesh along a line
        FLAT.replace("CELLS", "1 6 1").replace("ENDS", "empty").replace("1.3 1", "1 1").replace("0.1 1", "0 1"),
        WEDGE,
    ],
    ids=["two dimensions", "one dimension", "axisymmetric"],
)
def test_flat_meshes_have_checkmeshs_determinants_and_aspect_ratios(
    tets: tuple[Path, FaceMesh], block: str, tmp_path: Path
) -> None:
    case, _ = tets
    shutil.rmtree(case / "0")
    (case / "system/blockMeshDict").write_text(block)
    foam(case, "blockMesh")
    said, report = figures(foam(case, "checkMesh", "-allGeometry")), judge(read_openfoam(case))
    for name in ("max_aspect_ratio", "min_determinant", "mean_determinant", "max_skewness", "min_volume_ratio"):
        which, metric = name.split("_", 1)
        ours = getattr(report.metrics[metric], which)
        assert ours == pytest.approx(said[name], rel=1e-5, abs=1e-10), name
    assert report.metrics["determinant"].over_limit == 0


@pytest.mark.parametrize(("size", "verdict"), [((1, 1, 2), "warn"), ((1, 2, 2), "warn"), ((2, 2, 2), "pass")])
def test_meshes_of_one_cell_across_have_no_determinant_for_checkmesh_either(
    size: tuple[int, int, int], verdict: str, tmp_path: Path
) -> None:
    # only inner faces count: fewer than three directions of them leave a gradient undetermined
    write_openfoam(duct((3, 3, 5)).face_mesh(), tmp_path, AIR)
    shutil.rmtree(tmp_path / "constant/polyMesh")
    counts = " ".join(map(str, size))
    (tmp_path / "system/blockMeshDict").write_text(
        BLOCK.replace("(8 8 16) simpleGrading (1 2 1)", f"({counts}) simpleGrading (1 1 1)")
    )
    foam(tmp_path, "blockMesh")
    report, text = judge(read_openfoam(tmp_path)), foam(tmp_path, "checkMesh", "-allGeometry", "-allTopology")
    assert report.verdict == verdict
    assert ("Mesh OK" in text) == (verdict == "pass")
    # plain checkMesh does not look at it, and solvers run: no failure
    assert "Mesh OK" in foam(tmp_path, "checkMesh")
    if verdict == "warn":
        assert report.metrics["determinant"].max == 0.0
        assert f"small determinant (< 0.001) found, number of cells: {report.cells}" in text
