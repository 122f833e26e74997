"""The dictionaries of a steady, creeping, incompressible case, each as text.

The schemes are the ones whose error vanishes with the mesh spacing on tetrahedra (docs/solving.md):

- With `Gauss linear` gradients drag settles 7 to 10 % too high however fine the mesh; with the velocity's gradient from
  the points, or with its correction for non-orthogonal faces limited, still 3 to 5 % where faces lean by 25 degrees.
- The pressure's gradient from the points keeps the balance of forces exactly.
- The pressure's correction is limited to half of what it corrects: without a limit, a handful of faces near 70 degrees
  makes the run diverge. Limiting the velocity's instead costs accuracy and does not help.
- Least squares over edge neighbors are as accurate, but diverged for 1 of 16 random mats; over point neighbors for
  none of 20.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.export.settings import Dialect
from pipeline.nouns.flow import Flow
from pipeline.nouns.patches import FIBERS, INLET, OUTLET
from pipeline.openfoam.environment import SOLVER
from pipeline.openfoam.foam_file import format_dictionary, format_header

"""Program that runs the case; OpenFOAM.org has had one for all solvers since its version 11."""


def format_fv_schemes(cyclic: bool = False) -> str:
    """`system/fvSchemes`.

    Beside cyclic patches OpenFOAM stops at least squares over neighbors, and the gradients from the points want
    the limit on the velocity's correction too.
    """
    gradient = "" if cyclic else "\n    grad(U)         pointCellsLeastSquares;"
    laplacian = "" if cyclic else "\n    laplacian(nuEff,U) Gauss linear corrected;"
    return format_dictionary(
        "fvSchemes",
        "system",
        f"""
ddtSchemes
{{
    default         steadyState;
}}
gradSchemes
{{
    default         Gauss pointLinear;{gradient}
}}
divSchemes
{{
    default         none;
    div(phi,U)      Gauss linear;
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}}
laplacianSchemes
{{
    default         Gauss linear limited 0.333;{laplacian}
}}
interpolationSchemes
{{
    default         linear;
}}
snGradSchemes
{{
    default         limited 0.333;
}}
""",
    )


def format_fv_solution() -> str:
    """`system/fvSolution`: consistent SIMPLE without relaxing the pressure."""
    return format_dictionary(
        "fvSolution",
        "system",
        """
solvers
{
    p
    {
        solver          GAMG;
        smoother        GaussSeidel;
        tolerance       1e-8;
        relTol          0.05;
    }
    U
    {
        solver          smoothSolver;
        smoother        symGaussSeidel;
        tolerance       1e-8;
        relTol          0.1;
    }
}
SIMPLE
{
    consistent      yes;
    nNonOrthogonalCorrectors 0;
    residualControl
    {
        p               1e-5;
        U               1e-5;
    }
}
relaxationFactors
{
    equations
    {
        U               0.9;
    }
}
""",
    )


def format_control_dict(flow: Flow, dialect: Dialect = "com", iterations: int = 2000) -> str:
    """`system/controlDict`, with function objects that tell pressure drop, flow rates and drag.

    An unconverged run would leave nothing, so the fields are written at the last iteration too.
    """
    objects = "".join(
        [
            _patch_value("inletPressure", INLET, "areaAverage", "p"),
            _patch_value("outletPressure", OUTLET, "areaAverage", "p"),
            _patch_value("inletFlow", INLET, "sum", "phi"),
            _patch_value("outletFlow", OUTLET, "sum", "phi"),
            _drag(flow),
            _stop(dialect),
        ]
    )
    return format_dictionary(
        "controlDict",
        "system",
        f"""
application     {SOLVER[dialect]};
solver          incompressibleFluid;
startFrom       latestTime;
startTime       0;
stopAt          endTime;
endTime         {iterations};
deltaT          1;
writeControl    timeStep;
writeInterval   {iterations};
purgeWrite      2;
writeFormat     binary;
writePrecision  10;
writeCompression off;
timeFormat      general;
timePrecision   8;
runTimeModifiable true;
functions
{{
{objects}}}
""",
    )


def _patch_value(name: str, patch: str, operation: str, field: str) -> str:
    # OpenFOAM.com selects the patch by regionType and name, OpenFOAM.org by select and patch
    return f"""    {name}
    {{
        type            surfaceFieldValue;
        libs            ("libfieldFunctionObjects.so");
        regionType      patch;
        name            {patch};
        select          patch;
        patch           {patch};
        operation       {operation};
        fields          ({field});
        writeFields     no;
        log             no;
        writeControl    timeStep;
        writeInterval   1;
    }}
"""


def _drag(flow: Flow) -> str:
    return f"""    drag
    {{
        type            forces;
        libs            ("libforces.so");
        patches         ({FIBERS});
        rho             rhoInf;
        rhoInf          {flow.density!r};
        CofR            (0 0 0);
        log             no;
        writeControl    timeStep;
        writeInterval   1;
    }}
"""


def _stop(dialect: Dialect) -> str:
    return f"""    stop
    {{
        // "touch stop" in the case's folder ends a run after its next iteration, with its fields written
        type            {"abort" if dialect == "com" else "stopAtFile"};
        libs            ("libutilityFunctionObjects.so");
        file            "$FOAM_CASE/stop";
        action          writeNow;
    }}
"""


def format_constant(flow: Flow, dialect: Dialect = "com") -> dict[str, str]:
    """Give the files of `constant/`: a Newtonian fluid's kinematic viscosity, and no turbulence.

    Examples
    --------
    >>> air = Flow(0.025, 293.0, 1.8e-5, 1.2, 65e-9)
    >>> sorted(format_constant(air)), sorted(format_constant(air, "org"))
    (['transportProperties', 'turbulenceProperties'], ['momentumTransport', 'physicalProperties'])
    """
    names = {
        "com": ("transportProperties", "turbulenceProperties"),
        "org": ("physicalProperties", "momentumTransport"),
    }[dialect]
    bodies = (
        f"""
transportModel  Newtonian;
viscosityModel  constant;
nu              [0 2 -1 0 0 0 0] {flow.viscosity / flow.density!r};
""",
        "simulationType  laminar;",
    )
    return {name: format_dictionary(name, "constant", body) for name, body in zip(names, bodies, strict=True)}


def format_field(name: str, kind: str, dimensions: str, internal: str, boundary: dict[str, str]) -> str:
    """Give a field in `0/`: the same value everywhere, and a condition per patch."""
    conditions = "".join(f"    {patch}\n    {{\n        {entry}\n    }}\n" for patch, entry in boundary.items())
    return (
        format_header(kind, name, "0")
        + f"\ndimensions      {dimensions};\ninternalField   uniform {internal};\nboundaryField\n{{\n{conditions}}}\n"
    )


_ALLRUN = """#!/bin/sh
# Checks the mesh and runs the solver: USE
cd "${0%/*}" || exit 1
case $PWD in *[!A-Za-z0-9_./+-]*)
    echo "OpenFOAM cannot take this path: $PWD"
    echo "go through a link: ln -s \\"\\$PWD\\" /tmp/case && cd /tmp/case && $0"
    exit 1 ;;
esac
# Debian's package has no environment to source, only this
if [ -z "$WM_PROJECT_DIR" ] && [ -d /usr/share/openfoam ]; then
    export WM_PROJECT_DIR=/usr/share/openfoam
fi

run() {
    name=$1; shift
    echo "$name: log.$name"
    if ! "$@" > "log.$name" 2>&1; then
        tail -n 20 "log.$name"
        echo "$name failed, see log.$name"
        exit 1
    fi
}

RUNS
for value in inletPressure inletFlow outletFlow; do
    echo "$value: $(tail -q -n 1 postProcessing/$value/*/surfaceFieldValue*.dat | tail -n 1)"
done
# OpenFOAM's incompressible pressure is over the density: m2/s2, not Pa
drop=$(tail -q -n 1 postProcessing/inletPressure/*/surfaceFieldValue*.dat | tail -n 1 |
    awk '{printf "%.5g", DENSITY * $2}')
echo "pressure drop: $drop Pa (inletPressure above is in m2/s2, over the air's density of DENSITY kg/m3)"
"""

_JUDGE = """# checkMesh ends with 0 even when checks fail
grep -q "Mesh OK" log.checkMesh || echo "warning: checkMesh is not content, see log.checkMesh"
"""

_RUNS = """cores=${1:-1}
run checkMesh checkMesh
JUDGE
if [ "$cores" -gt 1 ]; then
    sed -i -e "s/^numberOfSubdomains .*/numberOfSubdomains $cores;/" -e "s/n  *(1 1 .*/n       (1 1 $cores);/" \\
        system/decomposeParDict
    run decomposePar decomposePar -force
    run SOLVER ${MPIRUN:-mpirun} -np "$cores" env PWD="$PWD" SOLVER -parallel
    run reconstructPar reconstructPar -latestTime
else
    run SOLVER SOLVER
fi"""

_RUNS_IN_TILES = """run checkMesh ${MPIRUN:-mpirun} -np TILES env PWD="$PWD" checkMesh -parallel
JUDGE
run SOLVER ${MPIRUN:-mpirun} -np TILES env PWD="$PWD" SOLVER -parallel"""


def format_allrun(flow: Flow, dialect: Dialect = "com") -> str:
    """Script that checks the mesh and runs the case, on one core or more, and tells the pressure drop in Pa."""
    return _script("./Allrun [cores]", _RUNS, flow, dialect)


def format_allrun_in_tiles(flow: Flow, tiles: int, dialect: Dialect = "com") -> str:
    """Script for a case that is decomposed already: a process for each tile."""
    return _script("./Allrun", _RUNS_IN_TILES.replace("TILES", str(tiles)), flow, dialect)


def _script(use: str, runs: str, flow: Flow, dialect: Dialect) -> str:
    text = _ALLRUN.replace("USE", use).replace("RUNS", runs).replace("JUDGE\n", _JUDGE)
    return text.replace("SOLVER", SOLVER[dialect]).replace("DENSITY", repr(flow.density))


ALLCLEAN = """#!/bin/sh
# Removes what a run left behind: times, logs and the parts of a parallel run
cd "${0%/*}" || exit 1
rm -rf [1-9]* processor[0-9]* postProcessing log.* stop
"""

ALLCLEAN_IN_TILES = """#!/bin/sh
# Removes what a run left behind, times and logs; the mesh stays, since it is nowhere else
cd "${0%/*}" || exit 1
rm -rf [1-9]* processor[0-9]*/[1-9]* postProcessing log.* stop
"""
