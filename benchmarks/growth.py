"""How time and memory grow with the mat: `python -m benchmarks.growth FOLDER [SIDE ...]`.

Pieces of Fig. 10's mat of growing side [um]: one process up to the duct, one for the mesh, one for the verdict. The
table stands in docs/meshing.md between its marks, the plot is docs/gallery/mesh_growth.svg.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.analytics.tables.plots import save_figure
from pipeline.line.run import Run
from pipeline.nouns.fibers import Mat
from pipeline.nouns.quality import QualityReport
from validation.programs import spent
from validation.tables import filled, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIDES = (12.5, 25.0, 50.0, 100.0)
STEPS = {"mat, surface, duct": "enclosure", "mesh": "tetmesh", "quality": "quality"}
"""What is measured by itself, and the stage that it ends with."""
_PAGE = Path(__file__).parents[1] / "docs" / "meshing.md"
_PICTURE = _PAGE.parent / "gallery" / "mesh_growth.svg"


@dataclass(frozen=True, slots=True)
class Cost:
    """What a process took: processor time on all cores [s], wall time [s], peak of its memory [byte]."""

    seconds: float
    wall: float
    memory: float


@dataclass(frozen=True, slots=True)
class Growth:
    """What one mat took.

    Parameters
    ----------
    side : float [um]
    fibers, cells : int
    costs : dict of str to Cost
        By the names of `STEPS`.
    verdict : str
    """

    side: float
    fibers: int
    cells: int
    costs: dict[str, Cost]
    verdict: str

    def texts(self) -> tuple[str, ...]:
        """Give its row of the table."""
        of_steps = (
            f"{cost.seconds:.1f} s, {1e6 * cost.seconds / self.cells:.1f} us a cell, {cost.memory / 2**30:.2f} GiB"
            for cost in self.costs.values()
        )
        wall = sum(cost.wall for cost in self.costs.values())
        return f"{self.side:g} um", f"{self.fibers}", f"{self.cells:,}", *of_steps, f"{wall:.0f} s", self.verdict


def measured(folder: Path, side: float) -> Growth:
    """Run one mat, all stages anew.

    Raises
    ------
    SystemExit
        If a run fails.
    """
    place = folder / f"side_{side:g}"
    command = ["pipeline.cli", "run", "figure10", "--quiet", "--out", str(place), "--set", f"mat.side={side:g} um"]
    costs = {}
    for name, stage in STEPS.items():
        forced = ("mat", "surface", "enclosure") if stage == "enclosure" else (stage,)
        again = [word for each in forced for word in ("--force", each)]
        cost = spent(*command, "--until", stage, *again)
        made = Run.opened(place).manifests()
        wall = sum(made[each]["seconds"] for each in forced)
        costs[name] = Cost(cost.seconds, wall, cost.memory)
    run = Run.opened(place)
    report = run.read(QualityReport)
    return Growth(side, run.read(Mat).fibers, report.cells, costs, report.verdict)


def drawn(rows: list[Growth]) -> "Figure":
    """Draw time and memory against cells."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 3), layout="constrained")
    times, memory = figure.subplots(1, 2)
    cells = [row.cells for row in rows]
    for name in STEPS:
        times.loglog(cells, [row.costs[name].seconds for row in rows], "o-", label=name)
        memory.loglog(cells, [row.costs[name].memory / 2**30 for row in rows], "o-", label=name)
    for axes, label in ((times, "processor time / s"), (memory, "peak of memory / GiB")):
        axes.set(xlabel="tetrahedra", ylabel=label)
        axes.grid(True, which="both", alpha=0.3)
    times.legend(frameon=False)
    return figure


def main(folder: Path, sides: tuple[float, ...]) -> None:
    """Measure all, and put table and plot into the documentation."""
    folder.mkdir(parents=True, exist_ok=True)
    # the loops are compiled when they first run
    measured(folder / "first", 8.0)
    rows = [measured(folder, side) for side in sides]
    content = table(("side", "fibers", "cells", *STEPS, "wall", "verdict"), [row.texts() for row in rows])
    print(content)
    _PAGE.write_text(filled(_PAGE.read_text(encoding="utf-8"), "growth", content), encoding="utf-8")
    save_figure(drawn(rows), _PICTURE)


if __name__ == "__main__":
    main(Path(sys.argv[1]), tuple(float(side) for side in sys.argv[2:]) or SIDES)
