"""Runs OpenFOAM's own programs in tests, and reads what `checkMesh` prints."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import re
import subprocess
from pathlib import Path

from pipeline.nouns.flow import Flow

AIR = Flow(face_velocity=0.025, temperature=293.0, viscosity=1.8e-5, density=1.2, mean_free_path=65.3e-9)
ENVIRONMENT = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
_NUMBER = r"([-+0-9.eE]+)"
_FIGURES = {
    "max_openness": rf"Max cell openness = {_NUMBER}",
    "max_aspect_ratio": rf"Max aspect ratio = {_NUMBER}",
    "min_face_area": rf"Minimum face area = {_NUMBER}\. ",
    "max_face_area": rf"Maximum face area = {_NUMBER}\. ",
    "min_volume": rf"Min volume = {_NUMBER}\. ",
    "max_volume": rf"Max volume = {_NUMBER}\. ",
    "total_volume": rf"Total volume = {_NUMBER}\. ",
    "max_non_orthogonality": rf"Mesh non-orthogonality Max: {_NUMBER}",
    "mean_non_orthogonality": rf"Mesh non-orthogonality Max: \S+ average: {_NUMBER}",
    "max_skewness": rf"Max skewness = {_NUMBER}",
    "min_determinant": rf"Cell determinant \(wellposedness\) : minimum: {_NUMBER}",
    "mean_determinant": rf"Cell determinant .* average: {_NUMBER}",
    "min_face_weight": rf"Face interpolation weight : minimum: {_NUMBER}",
    "mean_face_weight": rf"Face interpolation weight .* average: {_NUMBER}",
    "min_volume_ratio": rf"Face volume ratio : minimum: {_NUMBER}",
    "mean_volume_ratio": rf"Face volume ratio .* average: {_NUMBER}",
}


def foam(case: Path, *command: str) -> str:
    """Run a program of OpenFOAM in a case and give what it prints."""
    done = subprocess.run(
        command, cwd=case, env={**ENVIRONMENT, "PWD": str(case)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{command}: {done.stdout[-3000:]}{done.stderr[-2000:]}"
    return done.stdout


def figures(text: str) -> dict[str, float]:
    """Every figure of a mesh that `checkMesh -allGeometry` printed."""
    found = {name: re.search(pattern, text) for name, pattern in _FIGURES.items()}
    return {name: float(match[1]) for name, match in found.items() if match}


def patches(text: str) -> dict[str, int]:
    """Faces of each patch, as `checkMesh` printed them."""
    table = text.split("Checking patch topology")[1].split("\n\n")[0]
    return {name: int(count) for name, count in re.findall(r"^ +(\S+) +(\d+) +\d+ ", table, re.MULTILINE)}
