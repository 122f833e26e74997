"""Scripts that stand beside the case, so that it can be meshed anywhere: here, on another machine, on a cluster."""

# SPDX-License-Identifier: GPL-3.0-or-later

MESH_SCRIPT, JOB_SCRIPT = "Allmesh", "submit.slurm"

_ALLMESH = """#!/bin/sh
# Meshes the air between the fibers: ./Allmesh [cores]
# The mesh is left in constant/polyMesh, in meters; what went before it is removed first.
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
cores=${1:-CORES}
unit=UNIT # meters in one length of the dictionaries, the mean fiber diameter

run() {
    name=$1; shift
    echo "$name: log.$name"
    if ! "$@" > "log.$name" 2>&1; then
        tail -n 20 "log.$name"
        echo "$name failed, see log.$name"
        exit 1
    fi
}

rm -rf constant/polyMesh processor[0-9]* log.*
run blockMesh blockMesh
if [ "$cores" -gt 1 ]; then
    # slices across the flow, or columns along it too where slices would be thin
    split=$(awk -v cores="$cores" -v x=BLOCKS_X -v y=BLOCKS_Y -v z=BLOCKS_Z 'BEGIN {
        least = -1
        for (i = 1; i <= cores; i++) if (cores % i == 0)
            for (j = 1; j <= cores / i; j++) if (cores / i % j == 0) {
                k = cores / i / j
                # area of the cuts
                cut = (i - 1) * y * z + (j - 1) * x * z + (k - 1) * x * y
                if (least < 0 || cut < least) { least = cut; best = i " " j " " k }
            }
        print best
    }')
    sed -i -e "s/^numberOfSubdomains .*/numberOfSubdomains $cores;/" -e "s/n  *(.*/n       ($split);/" \\
        system/decomposeParDict
    run decomposePar decomposePar -force
    run snappyHexMesh ${MPIRUN:-mpirun} -np "$cores" env PWD="$PWD" snappyHexMesh -parallel -overwrite
    run reconstructParMesh reconstructParMesh -constant
    rm -rf processor[0-9]*
else
    run snappyHexMesh snappyHexMesh -overwrite
fi
# neighbors in space become neighbors in memory, which saves the solver a quarter of its time
run renumberMesh renumberMesh -overwrite
run transformPoints transformPoints -scale "($unit $unit $unit)"
run checkMesh checkMesh
# checkMesh ends with 0 even when checks fail
grep -q "Mesh OK" log.checkMesh || echo "warning: checkMesh is not content, see log.checkMesh"
"""

_SUBMIT = """#!/bin/bash
# Meshes this case on a cluster: sbatch --ntasks=64 submit.slurm
#SBATCH --job-name=fibertwin-mesh
#SBATCH --ntasks=CORES
#SBATCH --mem-per-cpu=4G
#SBATCH --time=04:00:00
# SLURM runs a copy of this script from elsewhere
cd "${SLURM_SUBMIT_DIR:-$(dirname "$0")}" || exit 1
# load OpenFOAM and the MPI it was built with here, where your cluster has modules: module load openfoam
export OMP_NUM_THREADS=1
./Allmesh "${SLURM_NTASKS:-CORES}"
"""


def format_mesh_script(unit: float, cores: int, counts: tuple[int, int, int]) -> str:
    """Script that makes the mesh from the case's files alone.

    Parameters
    ----------
    unit : float [m]
        What the dictionaries measure lengths in.
    cores : int
        Where the script is not told.
    counts : tuple of 3 ints
        Blocks along x, y and z; the cuts between processes cross as few as possible.
    """
    text = _ALLMESH.replace("CORES", str(cores)).replace("UNIT", repr(unit))
    for axis, count in zip("XYZ", counts, strict=True):
        text = text.replace(f"BLOCKS_{axis}", str(count))
    return text


def format_job_script(cores: int) -> str:
    """SLURM script that runs the mesh script."""
    return _SUBMIT.replace("CORES", str(max(cores, 2)))
