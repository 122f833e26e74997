"""Our own mats as tomograms, and back: what is lost of their solidity and of their pressure drop.

``python -m validation.tomograms FOLDER`` prints the table of docs/measuring.md. A mat is solved as it is; then it is
laid on voxels, told again from gray values, meshed from the surface of its voxels alone, and solved.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.case import Case, read_case
from pipeline.cli.tomograms import surface_of_tomogram
from pipeline.line.run import Run, run
from pipeline.nouns.flow import Solution
from pipeline.nouns.surface import Surface
from pipeline.progress import silent
from pipeline.structure.voxels import room_in

FINENESS = (8, 12, 20)
"""Voxels to a fiber diameter."""
_ON_THE_WAY = frozenset({"quality", "export", "report"})


@dataclass(frozen=True, slots=True)
class Row:
    """A medium and its flow.

    Parameters
    ----------
    voxels : int, optional
        To a diameter; None of the mat itself.
    triangles : int
        Of its surface.
    solidity : float [-]
    no_slip, slip : float [Pa]
        Pressure drop.
    """

    voxels: int | None
    triangles: int
    solidity: float
    no_slip: float
    slip: float


def table(case: Case, folder: Path, fineness: tuple[int, ...] = FINENESS) -> list[Row]:
    """Solve a mat, and what comes back of it from voxels.

    Parameters
    ----------
    case : Case
    folder : Path
        Where the runs are kept; finished stages are used again.
    fineness : tuple of int

    Returns
    -------
    list of Row
        The mat itself first.
    """
    rows = [_solved(case, folder / "mat", None)]
    surface = Run(case, folder / "mat").read(Surface)
    for count in fineness:
        place = folder / f"voxels_{count}"
        twin = place / "case.toml"
        if not twin.exists():
            _taken_back(surface, count, place, twin)
        again = read_case(twin, (f"flow.face_velocity={case.flow.face_velocity} m/s",))
        again = again.model_copy(update={"solve": case.solve, "tetmesh": case.tetmesh, "enclosure": case.enclosure})
        rows.append(_solved(again, place / "run", count))
    return rows


def _taken_back(surface: Surface, count: int, place: Path, twin: Path) -> None:
    room = room_in(surface, count)
    random = np.random.default_rng(count)
    solid = room.distance < 0.0
    # two gray levels with noise between them, as a detector leaves it
    gray = (60 + 110 * solid + 12 * random.standard_normal(solid.shape)).clip(0, 255).astype(np.uint8)
    place.mkdir(parents=True, exist_ok=True)
    np.save(place / "tomogram.npy", gray.transpose(2, 1, 0))
    surface_of_tomogram(
        place / "tomogram.npy", f"{1e9 * room.voxel:.6f} nm", None, None, "uint8", "otsu", 30, False,
        place / "surface.vtp", twin, False, True, silent,
    )  # fmt: skip


def _solved(case: Case, folder: Path, count: int | None) -> Row:
    run(case, folder, "solve", without=_ON_THE_WAY)
    results = Run(case, folder)
    surface, solution = results.read(Surface), results.read(Solution)
    assert solution.pressure_drop_no_slip is not None
    assert solution.pressure_drop_slip is not None
    return Row(
        count,
        len(surface.triangles),
        surface.volume / surface.slab.face_area,
        solution.pressure_drop_no_slip,
        solution.pressure_drop_slip,
    )


def lines(rows: list[Row]) -> list[str]:
    """Give the table as Markdown: differences from the mat itself."""
    first = rows[0]
    found = [
        "| voxels per diameter | triangles | solid per face area | pressure drop, no slip | with slip |",
        "|---|---|---|---|---|",
        f"| the mat itself | {first.triangles:,} | {1e6 * first.solidity:.4g} um | {first.no_slip:.4g} Pa "
        f"| {first.slip:.4g} Pa |",
    ]
    for row in rows[1:]:
        changes = (row.solidity / first.solidity - 1, row.no_slip / first.no_slip - 1, row.slip / first.slip - 1)
        found.append(f"| {row.voxels} | {row.triangles:,} | " + " | ".join(f"{each:+.1%}" for each in changes) + " |")
    return found


if __name__ == "__main__":
    chosen = read_case(Path("cases/default.toml"), ("mat.stop.coverage=1",))
    print("\n".join(lines(table(chosen, Path(sys.argv[1])))))  # noqa: T201
