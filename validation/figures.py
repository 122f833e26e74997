"""The figures that README quotes, measured in one go: ``python -m validation.figures runs/figures``.

They stand in ``docs/data/figures.json``, with the commit that they are of, and README's table is made of them.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import os
import platform
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pipeline.line.run import Run
from pipeline.line.store import read_json
from pipeline.report.page.headline import headline
from validation.programs import spent
from validation.tables import filled

ROOT = Path(__file__).parents[1]
FIGURES = ROOT / "docs" / "data" / "figures.json"
README = ROOT / "README.md"
MARK = "figures of the default case"
_MODELS = ("davies", "kuwabara", "happel", "kuwabara_slip")


def measured(folder: Path) -> dict[str, Any]:
    """Run the default case from nothing, and collect what it gave and what it took.

    Parameters
    ----------
    folder : Path
        Of the run; what stands there is made again.
    """
    shutil.rmtree(folder, ignore_errors=True)
    began = time.monotonic()
    cost = spent("pipeline.cli", "run", "default", "--out", str(folder), "--quiet")
    run = Run.opened(folder)
    manifests = run.manifests()
    quality = read_json(folder / "quality" / "quality.json")
    measures = read_json(folder / "tetmesh" / "measures.json")
    solution = read_json(folder / "solve" / "solution.json")
    comparison = read_json(folder / "compare" / "comparison.json")
    metrics = quality["metrics"]
    number = headline(run)
    assert number is not None
    return {
        "commit": _commit(),
        "command": "fibertwin run default",
        "processor": f"{platform.machine()}, {os.cpu_count()} cores",
        "wall_seconds": round(time.monotonic() - began, 1),
        "processor_seconds": round(cost.seconds, 1),
        "stage_seconds": {name: round(manifest["seconds"], 2) for name, manifest in manifests.items()},
        "peak_memory": cost.memory,
        "fibers": manifests["mat"]["counts"]["fibers"],
        "cells": quality["cells"],
        "verdict": quality["verdict"],
        "non_orthogonality": [metrics["non_orthogonality"]["max"], metrics["non_orthogonality"]["mean"]],
        "skewness": metrics["skewness"]["max"],
        "wall_deviation": [measures["fidelity"]["mean_deviation"], measures["fidelity"]["typical_deviation"]],
        "solidity": comparison["solidity"],
        "models": {name: comparison["models"][name]["mesh"] for name in _MODELS},
        "headline": {"interval": number.interval, "of": number.of, "notes": number.notes},
        "solution": {
            name: solution[name]
            for name in (
                "engine", "fiber_wall", "pressure_drop", "pressure_drop_slip", "pressure_drop_no_slip", "iterations",
                "force_balance_error", "mass_balance_error",
            )
        },
    }  # fmt: skip


def _commit() -> str:
    done = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return done.stdout.strip()


def table(figures: Mapping[str, Any]) -> str:
    """Write the figures as README shows them."""
    f, s = figures, figures["solution"]
    drops = {wall: s[f"pressure_drop_{wall}"] for wall in ("slip", "no_slip")}
    shown = " · ".join(
        f"{words} {drops[wall]:.3g} Pa"
        for wall, words in (("slip", "air slips along the fibers:"), ("no_slip", "no slip:"))
        if drops[wall] is not None
    )
    models = f["models"]
    rows = [
        ("time, memory", f"{f['wall_seconds']:.0f} s on {f['processor']}, {f['processor_seconds']:.0f} s of processor "
         f"time; {f['peak_memory'] / 2**30:.2f} GB"),
        ("mesh", f"{f['cells']:,} tetrahedra; non-orthogonality {f['non_orthogonality'][0]:.1f} degrees at most, "
         f"{f['non_orthogonality'][1]:.1f} on average; skewness {f['skewness']:.1f} at most"),
        ("walls off the true fibers", f"{f['wall_deviation'][0]:.3f} diameters on average, 99 % within "
         f"{f['wall_deviation'][1]:.2f}"),
        ("solidity nominal / surface / mesh",
         " / ".join(f"{f['solidity'][which]:.2%}" for which in ("nominal", "surface", "mesh"))),
        ("pressure drop at 2.5 cm/s, solved", f"{shown}; forces balance to {abs(s['force_balance_error']):.1g}"),
        ("its interval", " ".join([f["headline"]["interval"] + ".", f["headline"]["of"], f["headline"]["notes"][-1]])),
        ("models, from the mesh's solidity", f"Davies {models['davies']:.3g}, Kuwabara {models['kuwabara']:.3g} "
         f"(with slip {models['kuwabara_slip']:.3g}), Happel {models['happel']:.3g} Pa"),
    ]  # fmt: skip
    return "\n".join(["| | |", "|---|---|", *(f"| {what} | {value} |" for what, value in rows)])


def written(page: str, figures: Mapping[str, Any]) -> str:
    """Put the figures into README's text."""
    return filled(page, MARK, table(figures))


def main(folder: Path) -> None:
    """Measure, and write the file and the page."""
    figures = measured(folder)
    FIGURES.parent.mkdir(exist_ok=True)
    FIGURES.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    README.write_text(written(README.read_text(encoding="utf-8"), figures), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
