"""How time and memory of a mesh grow with the mat: `python -m benchmarks.growth FOLDER [SIDE ...]`.

Pieces of Fig. 10's mat of growing side, each from case to mesh in a process of its own; writes a table and growth.svg.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import subprocess
import sys
from pathlib import Path

from pipeline.case import read_case
from pipeline.cli.bundled import found
from pipeline.line.run import Run
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh_measures import TetmeshMeasures

SIDES = (12.5, 25.0, 50.0, 100.0)


def measured(folder: Path, side: float) -> tuple[int, int, float, float]:
    """Fibers, cells, processor seconds and bytes of one mat, from its case to its mesh."""
    place = folder / f"side_{side:g}"
    command = [
        sys.executable,
        "-m",
        "pipeline.cli",
        "run",
        "figure10",
        "--until",
        "tetmesh",
        "--quiet",
        "--out",
        str(place),
    ]
    child = subprocess.Popen([*command, "--set", f"mat.side={side:g} um"])
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"the mat of {side:g} um failed")
    run = Run(read_case(found(Path("figure10"))), place)
    return (
        run.read(Mat).fibers,
        run.read(TetmeshMeasures).cells,
        usage.ru_utime + usage.ru_stime,
        usage.ru_maxrss * 1024.0,
    )


def main(folder: Path, sides: tuple[float, ...]) -> None:
    """Measure all and write what came out."""
    from matplotlib.figure import Figure

    folder.mkdir(parents=True, exist_ok=True)
    rows = [measured(folder, side) for side in sides]
    print("| side | fibers | cells | processor time | memory |")
    print("|---|---|---|---|---|")
    for side, (fibers, cells, seconds, memory) in zip(sides, rows, strict=True):
        print(f"| {side:g} um | {fibers} | {cells:,} | {seconds:.0f} s | {memory / 2**30:.2f} GiB |")
    figure = Figure(figsize=(7, 3), layout="constrained")
    for axes, column, unit, label in zip(
        figure.subplots(1, 2), (2, 3), (1.0, 2.0**30), ("processor time [s]", "memory [GiB]"), strict=True
    ):
        axes.loglog([row[0] for row in rows], [row[column] / unit for row in rows], "o-", color="#3b82c4")
        axes.set_xlabel("fibers")
        axes.set_ylabel(label)
        axes.grid(True, which="both", alpha=0.3)
    figure.savefig(folder / "growth.svg", metadata={"Date": None})


if __name__ == "__main__":
    main(Path(sys.argv[1]), tuple(float(side) for side in sys.argv[2:]) or SIDES)
