"""Compare the models' pressure drops from the nominal, the surface's and the mesh's solidity."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.analytics.models.comparison import compare, compare_body
from pipeline.geometry.tets import volume_between
from pipeline.line import store
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.surface import Surface
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Ask every model."""
    surface, flow = results.read(Surface), results.case.flow.flow()
    slab = surface.slab
    air = volume_between(*results.read(FaceMesh).boundary(), slab.lower[2], slab.upper[2])
    solidity = 1.0 - air / slab.volume
    if results.case.mat.generator == "surface":
        diameter = 2.0 * float(surface.radius[0])
        comparison = compare_body(slab.size[2], diameter, surface.solidity, solidity, flow)
    else:
        comparison = compare(results.read(Mat), surface.solidity, solidity, flow)
    store.write_json(into / "comparison.json", comparison)
    return {"mesh_solidity": comparison.solidity["mesh"]}
