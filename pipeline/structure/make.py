"""Measure the pores between the fibers of a run, and keep what was found."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.line import store
from pipeline.nouns.fibers import Mat
from pipeline.nouns.surface import Surface
from pipeline.progress import Progress
from pipeline.structure.area import specific_surface
from pipeline.structure.measure import structure_of
from pipeline.structure.voxels import room_in

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Measure the pores."""
    surface, settings, mat = results.read(Surface), results.case.structure, results.get(Mat)
    progress("distances to the fibers", 0.0)
    room = room_in(surface, settings.voxels_per_diameter)
    area = specific_surface(surface, settings.fiber_density)
    found = structure_of(room, mat is not None and mat.periodic, area, progress)
    store.write_json(into / "structure.json", found)
    return {
        "mean_pore": found.pores.mean,
        "bubble_point": found.bubble_point,
        "mean_flow_pore": found.mean_flow_pore,
        "tortuosity": found.tortuosity,
    }
