"""Engines side by side on one case: `python -m benchmarks.meshers FOLDER [CASE]`.

Each meshes the same air in a process of its own; processor seconds and memory are those of that process and all it
starts. `plain` is `pytetwild.tetrahedralize` called with nothing but the surface.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import os
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from pipeline.case import read_case
from pipeline.cli.bundled import found as find_case
from pipeline.geometry.faces import tet_faces
from pipeline.line import store
from pipeline.line.run import run
from pipeline.mesh.fill import fill
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.quality.judge import judge

ENGINES = ("plain", "tetwild", "snappy", "lattice")
GROWTH = {"tetwild": 0.4, "snappy": 0.4}
"""What an engine was tuned to, where it is not the default."""


@dataclass(frozen=True, slots=True)
class Row:
    """What one engine made, and what it took."""

    engine: str
    cells: int
    max_angle: float
    mean_angle: float
    skewness: float
    solid_error: float
    verdict: str
    seconds: float = 0.0
    memory: float = 0.0


def mesh_with(engine: str, folder: Path) -> Row:
    """Mesh the air that stands in a run's folder."""
    case, domain = read_case(folder / "case.toml"), store.load(FluidDomain, folder / "run" / "enclosure" / "domain.npz")
    if engine == "plain":
        mesh = plain(domain)
    else:
        changes = {"engine": engine} | ({"growth": GROWTH[engine]} if engine in GROWTH else {})
        mesh, _ = fill(domain, case.tetmesh.changed(**changes))
    report = judge(mesh)
    angle = report.metrics["non_orthogonality"]
    error = (domain.volume - mesh.volume) / (domain.box.volume - domain.volume)
    return Row(engine, mesh.cells, angle.max, angle.mean, report.metrics["skewness"].max, error, report.verdict)


def plain(domain: FluidDomain) -> FaceMesh:
    """Mesh as a user of the library would, at size one, since it loses triangles at micrometers."""
    import pytetwild

    unit = 2.0 * float(domain.radius.mean())
    points, tets = pytetwild.tetrahedralize(domain.points / unit, domain.triangles.astype(np.int32), vtk_ordering=True)
    found = tet_faces(np.asarray(tets, np.int64))
    internal, faces = len(found.neighbour), len(found.triangles)
    return FaceMesh(
        np.asarray(points) * unit, found.triangles.ravel(), np.arange(0, 3 * faces + 1, 3), found.owner,
        found.neighbour, len(tets), (Patch("boundary", internal, faces - internal),),
    )  # fmt: skip


def measured(engine: str, folder: Path) -> Row | None:
    """Run one engine in a process of its own; None where it fails."""
    command = [sys.executable, "-m", "benchmarks.meshers", str(folder), "--one", engine]
    with (folder / f"{engine}.log").open("wb") as log:
        child = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(child.pid, 0)
    result = folder / f"{engine}.json"
    if status or not result.exists():
        return None
    row = json.loads(result.read_text())
    return Row(**{**row, "seconds": usage.ru_utime + usage.ru_stime, "memory": usage.ru_maxrss * 1024})


def table(rows: list[Row]) -> str:
    """Rows for a page."""
    lines = [
        "| engine | processor time | memory | cells | angle max / mean [deg] | skewness | solid volume | verdict |"
    ]
    lines.append("|---|---|---|---|---|---|---|---|")
    lines += [
        f"| {row.engine} | {row.seconds:.1f} s | {row.memory / 2**30:.2f} GiB | {row.cells:,} | "
        f"{row.max_angle:.1f} / {row.mean_angle:.1f} | {row.skewness:.2f} | {row.solid_error:+.3%} | {row.verdict} |"
        for row in rows
    ]
    return "\n".join(lines)


def main(folder: Path, case: str) -> None:
    """Make the air once, mesh it by every engine, and print the table."""
    folder.mkdir(parents=True, exist_ok=True)
    path = find_case(Path(case))
    (folder / "case.toml").write_text(path.read_text())
    run(read_case(path), folder / "run", until="enclosure")
    mesh_with("lattice", folder)  # whatever numba has to compile is compiled
    rows = []
    for engine in ENGINES:
        row = measured(engine, folder)
        print(f"{engine}: {'failed, see its log' if row is None else f'{row.seconds:.1f} s'}", flush=True)
        rows += [row] if row else []
    (folder / "meshers.md").write_text(table(rows) + "\n")
    print(table(rows))


if __name__ == "__main__":
    place = Path(sys.argv[1])
    if "--one" in sys.argv:
        name = sys.argv[3]
        (place / f"{name}.json").write_text(json.dumps(asdict(mesh_with(name, place))))
    else:
        main(place, sys.argv[2] if len(sys.argv) > 2 else "default")
