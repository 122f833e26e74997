"""Put the fibers into their duct, and keep the surface of the air."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.enclosure.duct import enclose
from pipeline.line import store
from pipeline.nouns.surface import Surface
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Cut the fibers out of the duct."""
    domain = enclose(results.read(Surface), results.case.enclosure, progress)
    store.save(domain, into / "domain.npz")
    return {"triangles": len(domain.triangles), "fluid_volume": domain.volume}
