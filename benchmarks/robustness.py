"""Many small mats through a mesher: ``python -m benchmarks.robustness [SEEDS [ENGINE]]`` tells what became of them.

Each kind of mat goes with each way of contact and each seed; the engine is the lattice unless named, the edge the
default. The table goes into docs/meshing.md.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import resource
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pipeline.enclosure.duct import enclose
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.errors import FibertwinError
from pipeline.mat.generate import generate
from pipeline.mat.settings import LayeredSettings
from pipeline.mesh.fill import fill
from pipeline.mesh.settings import TetmeshSettings
from pipeline.quality.judge import judge
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite
from validation.tables import filled, table

PAGE = Path(__file__).parents[1] / "docs" / "meshing.md"
SIDE, DIAMETER = 8e-6, 1.4e-6
MIXTURE = {"distribution": "mixture", "parts": [
    {"weight": 0.6, "diameter": {"distribution": "constant", "diameter": 0.9e-6}},
    {"weight": 0.4, "diameter": {"distribution": "constant", "diameter": 1.8e-6}},
]}  # fmt: skip
KINDS: dict[str, dict[str, object]] = {
    "one diameter, slope 0": {"relaxation_slope": 0.0},
    "one diameter, slope 0.15": {"relaxation_slope": 0.15},
    "one diameter, slope 0.25": {"relaxation_slope": 0.25},
    "two diameters, slope 0.15": {"fiber_diameter": MIXTURE, "relaxation_slope": 0.15},
    "broken ends, slope 0.15": {"relaxation_slope": 0.15, "broken": 0.5},
}
CONTACTS = ("paper", "clear")


@dataclass(frozen=True, slots=True)
class Fate:
    """What became of one mat."""

    verdict: str
    seconds: float
    cells: int = 0
    angle: float = 0.0
    skewness: float = 0.0
    filled: float = 0.0
    off: float = 0.0
    reason: str = ""


def mat_settings(kind: str, contact: str, seed: int) -> LayeredSettings:
    """Give the settings of one mat: a face of some six diameters, covered 1.2 times."""
    content = {"side": SIDE, "fiber_diameter": DIAMETER, "contact": contact, "seed": seed, "stop": {"coverage": 1.2}}
    return LayeredSettings.model_validate({"generator": "layered", **content, **KINDS[kind]})


def fate(kind: str, contact: str, seed: int, engine: str = "lattice") -> Fate:
    """Grow, unite, enclose, mesh and judge one mat; what a user could mend is a verdict of its own."""
    began = _processor_seconds()
    try:
        surface = unite(generate(mat_settings(kind, contact, seed)), SurfaceSettings())
        domain = enclose(surface, EnclosureSettings(inlet=4e-6, outlet=4e-6))
        mesh, measures = fill(domain, TetmeshSettings(engine=engine))
    except FibertwinError as problem:
        return Fate("refused", _processor_seconds() - began, reason=str(problem))
    report = judge(mesh)
    metrics = report.metrics
    assert measures.fidelity is not None
    return Fate(
        report.verdict, _processor_seconds() - began, mesh.cells, metrics["non_orthogonality"].max,
        metrics["skewness"].max, measures.filled_volume, measures.fidelity.largest_deviation, "; ".join(report.reasons),
    )  # fmt: skip


def _processor_seconds() -> float:
    """Seconds of this process and of what it has started."""
    used = [resource.getrusage(which) for which in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def fates(seeds: int, engine: str) -> Iterator[tuple[str, str, list[Fate]]]:
    """Give what became of the mats of each kind and contact."""
    for kind in KINDS:
        for contact in CONTACTS:
            yield kind, contact, [fate(kind, contact, seed, engine) for seed in range(seeds)]


def main(seeds: int, engine: str) -> None:
    """Print the table and put it into the page, and print the reason of each that did not pass."""
    lines = []
    for kind, contact, found in fates(seeds, engine):
        counts = [sum(each.verdict == verdict for each in found) for verdict in ("pass", "warn", "fail", "refused")]
        lines.append(
            [
                kind,
                contact,
                *(str(count) for count in (len(found), *counts)),
                f"{max(each.angle for each in found):.1f}",
                f"{max(each.skewness for each in found):.2f}",
                f"{max(each.filled for each in found):.1e}",
                f"{max(each.off for each in found):.2f} d",
                f"{sum(each.seconds for each in found) / len(found):.2f} s",
            ]
        )
        print(*lines[-1], sep=" | ", flush=True)
        for seed, each in enumerate(found):
            if each.verdict != "pass":
                print(f"  seed {seed}: {each.verdict}: {each.reason}", file=sys.stderr)
    head = ["mat", "contact", "mats", "pass", "warn", "fail", "refused", "worst angle", "worst skewness", "air filled",
            "wall farthest off", "time"]  # fmt: skip
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8"), f"seeds, {engine}", table(head, lines)), encoding="utf-8")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100, sys.argv[2] if len(sys.argv) > 2 else "lattice")
