#!/bin/sh
# SLURM: one case, from fibers to particles caught. sbatch starters/slurm.sh filter.toml
# Not run here, where SLURM is not installed; bash -n passes. A job that is killed goes on when it is submitted again.
#SBATCH --job-name=fibertwin
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=8
#SBATCH --mem=16G
#SBATCH --time=12:00:00
set -eu
case_file=${1:?usage: sbatch starters/slurm.sh CASE}
name=$(basename "$case_file" .toml)
export OMP_NUM_THREADS="${SLURM_CPUS_PER_TASK:-1}" NUMBA_NUM_THREADS="${SLURM_CPUS_PER_TASK:-1}"
fibertwin run "$case_file" --out "runs/$name" --until capture
