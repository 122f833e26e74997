"""The dictionaries of blockMesh and snappyHexMesh, each as text; lengths are in mean fiber diameters.

snappyHexMesh has limits that are lengths, areas and volumes, so that it works at size one.
Points are moved onto the fibers in ten rounds, as many as features would get, but no features are given: the default
case's fibers then lose 0.03 % of their volume. In one round they gain 2.8 %; with the rims on the sides as features
they lose 0.3 %, with the creases between fibers given too 2.3 %; with creases found by snappyHexMesh they gain 2.7 %.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.mesh.engines.snappy.layout import Layout
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.patches import DUCT, FIBERS, LOWER, UPPER
from pipeline.openfoam.foam_file import format_dictionary

SURFACE = "fibers.obj"

# Corners of a block's faces by axis and end, outward; corner 4 z + (0, 1, 3, 2)[x + 2 y]
_CORNERS = {
    (0, LOWER): "0 4 7 3",
    (0, UPPER): "1 2 6 5",
    (1, LOWER): "0 1 5 4",
    (1, UPPER): "3 7 6 2",
    (2, LOWER): "0 3 2 1",
    (2, UPPER): "4 5 6 7",
}
_FACES = {patch.name: _CORNERS[patch.axis, patch.end] for patch in DUCT if patch.axis is not None}


def format_vector(vector: tuple[float, float, float]) -> str:
    """Give a vector with every digit.

    Examples
    --------
    >>> format_vector((0.1, 2.0, -3.0))
    '(0.1 2.0 -3.0)'
    """
    return "(" + " ".join(map(repr, vector)) + ")"


def format_block_mesh(lower: Floats, upper: Floats, layout: Layout) -> str:
    """`system/blockMeshDict`: the duct in equal blocks, its planes the patches in the order of all meshes here."""
    (x0, y0, z0), (x1, y1, z1) = lower.tolist(), upper.tolist()
    around = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    vertices = "".join(f"    {format_vector((x, y, z))}\n" for z in (z0, z1) for x, y in around)
    patches = "".join(f"    {name} {{ type patch; faces (({face})); }}\n" for name, face in _FACES.items())
    return format_dictionary(
        "blockMeshDict",
        "system",
        f"""
scale           1;
vertices
(
{vertices});
blocks
(
    hex (0 1 2 3 4 5 6 7) ({" ".join(map(str, layout.counts))}) simpleGrading (1 1 1)
);
edges ();
boundary
(
{patches});
mergePatchPairs ();
""",
    )


def format_snappy(layout: Layout) -> str:
    """`system/snappyHexMeshDict`: halve the cells at the fibers, drop those behind them, move the rest onto them.

    The limits of the quality are those of the stage `quality`, a little inside where moving may exceed them.
    """
    return format_dictionary(
        "snappyHexMeshDict",
        "system",
        f"""
castellatedMesh true;
snap            true;
addLayers       false;
geometry
{{
    {SURFACE}
    {{
        type            triSurfaceMesh;
        name            {FIBERS};
    }}
}}
castellatedMeshControls
{{
    maxLocalCells   1000000000;
    maxGlobalCells  2000000000;
    minRefinementCells 0;
    maxLoadUnbalance 0.1;
    nCellsBetweenLevels {layout.buffer};
    features        ();
    refinementSurfaces
    {{
        {FIBERS}
        {{
            level           ({layout.level} {layout.level});
            patchInfo
            {{
                type            wall;
            }}
        }}
    }}
    resolveFeatureAngle 30;
    refinementRegions
    {{{_regions(layout)}
    }}
    locationInMesh  {format_vector(layout.inside)};
    allowFreeStandingZoneFaces false;
}}
snapControls
{{
    nSmoothPatch    3;
    tolerance       2;
    nSolveIter      30;
    nRelaxIter      5;
    nFeatureSnapIter 10;
    implicitFeatureSnap false;
    explicitFeatureSnap false;
    multiRegionFeatureSnap false;
}}
addLayersControls
{{
    relativeSizes   true;
    layers
    {{
    }}
    expansionRatio  1;
    finalLayerThickness 0.3;
    minThickness    0.1;
    nGrow           0;
    featureAngle    60;
    nRelaxIter      3;
    nSmoothSurfaceNormals 1;
    nSmoothNormals  3;
    nSmoothThickness 10;
    maxFaceThicknessRatio 0.5;
    maxThicknessToMedialRatio 0.3;
    minMedianAxisAngle 90;
    nBufferCellsNoExtrude 0;
    nLayerIter      50;
}}
meshQualityControls
{{
    maxNonOrtho     65;
    maxBoundarySkewness 4;
    maxInternalSkewness 4;
    maxConcave      80;
    minVol          1e-12;
    minTetQuality   1e-15;
    minArea         -1;
    minTwist        0.02;
    minDeterminant  0.001;
    minFaceWeight   0.05;
    minVolRatio     0.01;
    minTriangleTwist -1;
    nSmoothScale    4;
    errorReduction  0.75;
    relaxed
    {{
        maxNonOrtho     70;
    }}
}}
mergeTolerance  1e-6;
""",
    )


def _regions(layout: Layout) -> str:
    if not layout.reach:
        return ""
    # from the nearest, to the highest level, outward
    levels = " ".join(f"({layout.reach[k]!r} {k + 1})" for k in reversed(range(layout.level)))
    return f"""
        {FIBERS}
        {{
            mode            distance;
            levels          ({levels});
        }}"""


def format_control() -> str:
    """`system/controlDict` of programs that mesh and solve nothing."""
    return format_dictionary(
        "controlDict",
        "system",
        """
application     snappyHexMesh;
startFrom       startTime;
startTime       0;
stopAt          endTime;
endTime         1;
deltaT          1;
writeControl    timeStep;
writeInterval   1;
writeFormat     binary;
writePrecision  16;
writeCompression off;
timeFormat      general;
timePrecision   8;
runTimeModifiable false;
""",
    )


def format_schemes() -> str:
    """`system/fvSchemes`, which every program wants to see."""
    return format_dictionary(
        "fvSchemes",
        "system",
        """
gradSchemes
{
    default         Gauss linear;
}
divSchemes
{
    default         none;
}
laplacianSchemes
{
    default         Gauss linear corrected;
}
interpolationSchemes
{
    default         linear;
}
snGradSchemes
{
    default         corrected;
}
""",
    )


def format_solution() -> str:
    """`system/fvSolution`, likewise."""
    return format_dictionary("fvSolution", "system", "solvers\n{\n}\n")


def format_surface(points: Floats, triangles: Ints) -> str:
    r"""Give a surface as Wavefront OBJ with every digit; STL in binary would move its points.

    Examples
    --------
    >>> import numpy as np
    >>> format_surface(np.eye(3), np.array([[0, 1, 2]])).splitlines()
    ['g fibers', 'v 1.0 0.0 0.0', 'v 0.0 1.0 0.0', 'v 0.0 0.0 1.0', 'f 1 2 3']
    """
    vertices = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in (triangles + 1).tolist())
    return f"g {FIBERS}\n{vertices}{faces}"
