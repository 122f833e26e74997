"""Unite the fibers of a mat, or read a surface, measure it, and keep both."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.cad.surfaces import write_ply, write_stl
from pipeline.line import store
from pipeline.nouns.fibers import Mat
from pipeline.nouns.surface_file import SurfaceFile
from pipeline.progress import Progress
from pipeline.surface.measures import measure_surface
from pipeline.surface.union import unite

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Unite the fibers."""
    if results.case.mat.generator == "surface":
        return _own(results, into, progress)
    mat, settings = results.read(Mat), results.case.surface
    surface = unite(mat, settings, progress)
    store.save(surface, into / "surface.npz")
    store.write_json(into / "measures.json", measure_surface(mat, surface, settings, progress))
    write_stl(surface, into / "surface.stl")
    write_ply(surface, into / "surface.ply")
    return {"triangles": len(surface.triangles), "solidity": surface.solidity}


def _own(results: "Results", into: Path, progress: Progress) -> "Counts":
    from pipeline.surface.own import read_body

    surface, found = read_body(results.read(SurfaceFile), progress)
    store.save(surface, into / "surface.npz")
    store.write_json(into / "measures.json", found)
    write_stl(surface, into / "surface.stl")
    write_ply(surface, into / "surface.ply")
    return {"triangles": len(surface.triangles), "solidity": surface.solidity, "mended": found.mended}
