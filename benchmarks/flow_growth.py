"""How time and memory of a flow grow with the mesh: `python -m benchmarks.flow_growth FOLDER [EDGE ...]`.

The default case on meshes of the lattice, each solved with both walls in a process of its own, whose processor time
and memory are measured without those of meshing; writes a table and flow_growth.svg. Meshes that are there are taken.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import subprocess
import sys
import time
from pathlib import Path

from pipeline.case import read_case
from pipeline.cli.bundled import found
from pipeline.line import store
from pipeline.machine import cores, peak_memory
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import silent
from pipeline.solve.bed import Bed
from pipeline.solve.settings import StokesSettings
from pipeline.solve.stokes.solver import solve_stokes

EDGES = (1.0, 0.9, 0.5, 0.4)
_SOLIDITY = 0.1355  # of the default mesh; it decides about the gap between fibers alone


def solved(run: Path) -> dict[str, float]:
    """Solve the mesh of a run, and give what that took; compiled loops come from the disk but for the first time."""
    case = read_case(found(Path("default")))
    domain = store.load(FluidDomain, run / "enclosure/domain.npz")
    mesh = store.load(FaceMesh, run / "tetmesh/mesh.npz")
    before, began = time.process_time(), time.monotonic()
    solution, field, _ = solve_stokes(
        mesh, domain, case.flow.flow(), Bed(domain.slab.face_area, domain.slab.size[2]), _SOLIDITY,
        case.flow.fiber_wall, case.enclosure.sides, StokesSettings(), silent, cores(),
    )  # fmt: skip
    return {
        "cells": len(field.cells),
        "nodes": len(field.positions),
        "seconds": time.process_time() - before,
        "wall": time.monotonic() - began,
        "memory": peak_memory(),
        "iterations": solution.iterations,
        "drop": solution.pressure_drop,
        "no_slip": solution.pressure_drop_no_slip or 0.0,
    }


def measured(folder: Path, edge: float) -> dict[str, float]:
    """Mesh the default case at an edge, and solve it in a process of its own."""
    run = folder / f"edge_{edge:g}"
    mesh = [
        sys.executable, "-m", "pipeline.cli", "run", "default", "--until", "tetmesh", "--quiet", "--out", str(run),
        "--set", "tetmesh.engine=lattice", "--set", f"tetmesh.edge={edge:g}",
    ]  # fmt: skip
    subprocess.run(mesh, check=True)
    child = subprocess.run(
        [sys.executable, "-m", "benchmarks.flow_growth", "--solve", str(run)], check=True, capture_output=True
    )
    row: dict[str, float] = json.loads(child.stdout)
    return row


def main(folder: Path, edges: tuple[float, ...]) -> None:
    """Measure all and write what came out."""
    folder.mkdir(parents=True, exist_ok=True)
    print("| edge | cells | nodes | iterations | processor time | per cell | memory | per node | drop, slip / none |")
    print("|---|---|---|---|---|---|---|---|---|")
    rows = []
    for edge in edges:
        row = measured(folder, edge)
        rows.append(row)
        print(
            f"| {edge:g} | {row['cells']:,} | {row['nodes']:,} | {row['iterations']} | {row['seconds']:.1f} s | "
            f"{1e6 * row['seconds'] / row['cells']:.0f} us | {row['memory'] / 2**30:.2f} GiB | "
            f"{row['memory'] / row['nodes']:.0f} | {row['drop']:.4f} / {row['no_slip']:.4f} Pa |",
            flush=True,
        )
        draw(rows, folder / "flow_growth.svg")


def draw(rows: list[dict[str, float]], path: Path) -> None:
    """Draw time and memory against cells."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 3), layout="constrained")
    for axes, name, unit, label in zip(
        figure.subplots(1, 2),
        ("seconds", "memory"),
        (1.0, 2.0**30),
        ("processor time [s]", "memory [GiB]"),
        strict=True,
    ):
        cells = [row["cells"] for row in rows]
        axes.loglog(cells, [row[name] / unit for row in rows], "o-", color="#3b82c4")
        axes.set_xlabel("tetrahedra")
        axes.set_ylabel(label)
        axes.grid(True, which="both", alpha=0.3)
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    if sys.argv[1] == "--solve":
        print(json.dumps(solved(Path(sys.argv[2]))))
    else:
        main(Path(sys.argv[1]), tuple(float(edge) for edge in sys.argv[2:]) or EDGES)
