"""`fibertwin tomography`: from gray voxels to a surface, and to the case that it is the medium of."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from pipeline.cli.measuring import read_length
from pipeline.errors import CaseError
from pipeline.geometry.triangles import area_vectors, enclosed_volume
from pipeline.line.places import disk_trouble_explained
from pipeline.nouns.structure import SpecificSurface, Structure
from pipeline.progress import Progress
from pipeline.structure.measure import structure_of
from pipeline.structure.tables import structure_rows
from pipeline.tomography.contour import surface_of
from pipeline.tomography.read import MEMORY_PER_VOXEL, read_voxels
from pipeline.tomography.room import room_between
from pipeline.tomography.solid import segment
from pipeline.writing import whole_file, write_whole


def surface_of_tomogram(
    path: Path,
    voxel: str,
    window: str | None,
    shape: str | None,
    kind: str,
    threshold: str,
    smallest: int,
    dark: bool,
    surface: Path | None,
    case: Path | None,
    as_json: bool,
    quiet: bool,
    progress: Progress,
) -> None:
    """Read, segment, make the surface, write it and its case, and tell what it is like."""
    edge = read_length(voxel, "--voxel")
    assert edge is not None
    level = None if threshold == "otsu" else _number(threshold, "--threshold")
    if smallest < 0:
        raise CaseError(f"--smallest {smallest}: a number of voxels, 0 or more")
    into = surface or Path("runs") / path.stem / "surface.vtp"
    if into.suffix.lower() not in (".vtp", ".ply", ".stl"):
        raise CaseError(f"--surface {into}: write .vtp (64 bits), .ply or .stl")
    if case is not None and os.path.lexists(case):
        raise CaseError(f"{case} is there already; name another file for the case")
    progress(f"reading {path.name}")
    gray = read_voxels(path, _whole(window, 6, "--window"), _whole(shape, 3, "--shape"), kind)
    progress(f"{gray.size / 1e6:.1f} million voxels, about {gray.size * MEMORY_PER_VOXEL / 2**30:.1f} GiB")
    found = segment(gray, level, smallest, dark)
    progress("making the surface")
    points, triangles = surface_of(found.solid, edge)
    size = np.array(found.solid.shape) * edge
    volume, area = enclosed_volume(points, triangles), _free_area(points, triangles, size)
    progress("measuring the pores")
    surface_told = SpecificSurface(per_volume=area / float(np.prod(size)), per_solid=area / volume)
    structure = structure_of(room_between(found.solid, edge), periodic=False, surface=surface_told)
    told = {
        "voxels": list(found.solid.shape),
        "size": size.tolist(),
        "threshold": found.threshold,
        "islands": found.islands,
        "closed_pores": found.pores,
        "solidity": {
            "voxels": found.solidity,
            "surface": volume / float(np.prod(size)),
        },
        "triangles": len(triangles),
        "mean_diameter": 4.0 * volume / area,
        "structure": dataclasses.asdict(structure),
        "surface": str(into),
    }
    with disk_trouble_explained(into):
        _write(into, points, triangles)
    if case is not None:
        with disk_trouble_explained(case):
            write_whole(case, _case(into, case, path))
    if as_json:
        sys.stdout.write(json.dumps(told, indent=2, allow_nan=False) + "\n")
    elif not quiet:
        _show(told, structure, into, case)


def _free_area(points: np.ndarray[Any, Any], triangles: np.ndarray[Any, Any], size: np.ndarray[Any, Any]) -> float:
    """Area without what the window's six sides cut [m2]."""
    corners = points[triangles]
    on_side = np.zeros(len(triangles), dtype=bool)
    for axis in range(3):
        for place in (0.0, size[axis]):
            on_side |= (corners[:, :, axis] == place).all(axis=1)
    return float(np.linalg.norm(area_vectors(points, triangles)[~on_side], axis=1).sum())


def _write(path: Path, points: np.ndarray[Any, Any], triangles: np.ndarray[Any, Any]) -> None:
    import pyvista as pv

    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as side:
        pv.PolyData.from_regular_faces(points * 1e6, triangles).save(side)


def _case(surface: Path, case: Path, source: Path) -> str:
    place = surface.resolve()
    return "\n".join(
        [
            f"# The medium of a tomogram, {' '.join(source.name.split())}.",
            "# Which pressure drop has it, solved on its own surface?",
            "",
            "[mat]",
            'generator = "surface"',
            f"file = {json.dumps(str(place))}",
            'unit = "um"',
            "",
            "[tetmesh]",
            'engine = "tetwild"',
            "",
            "[flow]",
            'face_velocity = "2.5 cm/s"',
            'temperature = "293 K"',
            "",
        ]
    )


def _show(told: dict[str, Any], structure: Structure, into: Path, case: Path | None) -> None:
    out = Console()

    def show(text: str) -> None:
        out.print(text, markup=False, highlight=False, soft_wrap=True)

    size = " x ".join(f"{1e6 * length:.4g}" for length in told["size"])
    share = told["solidity"]
    show(f"window          {size} um, {' x '.join(map(str, told['voxels']))} voxels")
    left_out = f"{told['islands']} voxels of islands and {told['closed_pores']} of pores left out"
    show(f"threshold       {told['threshold']:g}; {left_out}")
    show(f"solidity        {share['voxels']:.3%} of the voxels, {share['surface']:.3%} within the surface")
    show(f"mean diameter   {1e6 * told['mean_diameter']:.4g} um, from volume over surface")
    for name, text in structure_rows(structure):
        show(f"{name:<15} {text}")
    show(f"surface         {into}, {told['triangles']:,} triangles, in um")
    if case is not None:
        show(f"run it: fibertwin run {case}")


def _number(text: str, option: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise CaseError(f"{option} {text!r}: write otsu, or a gray value") from None


def _whole(text: str | None, count: int, option: str) -> Any:
    if text is None:
        return None
    try:
        numbers = tuple(int(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != count or (option == "--shape" and min(numbers, default=0) < 1):
        example = {"--window": "x0,y0,z0,x1,y1,z1, as 0,0,0,200,200,100", "--shape": "x,y,z, as 512,512,300"}[option]
        raise CaseError(f"{option} {text!r}: write {example}")
    return numbers
