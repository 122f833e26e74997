"""Measure what docs/verification.md shows, and write its tables and plots: ``make verify``.

``python docs/verify.py RUNS [PART ...]`` runs some parts only: square, hexagonal, slip, lattices, mats, filters, and
page, which writes tables and plots from what the others left in docs/verification. Finished runs are reused.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from pathlib import Path

from pipeline.analytics.tables.plots import save_figure
from pipeline.case import read_case
from pipeline.line.run import Run, run
from pipeline.nouns.flow import Solution
from pipeline.pictures.flow import read_flow, slice_figure, streamline_figure
from pipeline.pictures.panels import write_png
from pipeline.solve.settings import SolveSettings
from validation import filters, tables
from validation.ladder import SLIP, Rung, ladder
from validation.lattices import LatticeRung, lattices
from validation.mats import MatRun, mat_runs
from validation.plots import ladder_figure, mats_figure
from validation.records import read_records, write_records

DOCS = Path(__file__).parent
PAGE, RECORDS, GALLERY = DOCS / "verification.md", DOCS / "verification", DOCS / "gallery"
CASES = DOCS.parent / "cases"
ARRAYS = ("square", "hexagonal")
SLIP_SOLIDITIES = (0.1,)
FILTERS = ("default", "figure10_corner")
MESHERS = ("tetwild", "lattice")
PARTS = (*ARRAYS, "slip", "lattices", "mats", "filters", "page")


def told(what: str, done: float | None = None) -> None:
    """Say which stages are done."""
    if done == 1.0:
        sys.stderr.write(f"{what}\n")


def measure(part: str, runs: Path) -> None:
    """Run a part's cases and keep their figures."""
    if part == "slip":
        case = read_case(CASES / "verification" / "square.toml")
        write_records(RECORDS / "slip.csv", ladder(case, runs / "square", SLIP_SOLIDITIES, SLIP, told))
    elif part == "mats":
        write_records(
            RECORDS / "mats.csv", mat_runs(read_case(CASES / "verification" / "mat.toml"), runs / "mats", told)
        )
    elif part == "lattices":
        rungs = [rung for mesher in MESHERS for rung in lattices(runs / "lattices", mesher, told)]
        write_records(RECORDS / "lattices.csv", rungs)
    elif part == "filters":
        for name in FILTERS:
            solve_filter(name, runs / name)
    else:
        case = read_case(CASES / "verification" / f"{part}.toml")
        write_records(RECORDS / f"{part}.csv", ladder(case, runs / part, tell=told))


def solve_filter(name: str, folder: Path) -> None:
    """Solve a bundled case, keep its pressure drops, and draw the flow."""
    case = read_case(CASES / f"{name}.toml").model_copy(update={"solve": SolveSettings(engine="openfoam")})
    run(case, folder, "solve", tell=told, without=frozenset({"report"}))
    this = Run(case, folder)
    write_records(RECORDS / f"{name}.csv", filters.pressure_drops(this))
    flow = read_flow(folder / "solve" / "openfoam", case.flow.flow().density)
    title = f"cases/{name}.toml, {this.read(Solution).pressure_drop:.3g} Pa"
    write_png(slice_figure(flow, title), GALLERY / f"flow_{name}_slice.png")
    write_png(streamline_figure(flow, title), GALLERY / f"flow_{name}_streamlines.png")


def write_page() -> None:
    """Fill the page's tables and draw its plots."""
    page = PAGE.read_text(encoding="utf-8")
    arrays = [rung for name in ARRAYS for rung in read_records(RECORDS / f"{name}.csv", Rung)]
    slip = read_records(RECORDS / "slip.csv", Rung)
    mats = read_records(RECORDS / "mats.csv", MatRun)
    if (RECORDS / "lattices.csv").is_file():
        page = tables.filled(
            page, "lattices", tables.lattice_table(read_records(RECORDS / "lattices.csv", LatticeRung))
        )
    # the first mat is that of the case's own box, and on the coarsest mesh; the sizes came last, on the case's own
    resolution = [each for each in mats if each.side == mats[0].side]
    sizes = [each for each in mats if each.edge == mats[-1].edge]
    page = tables.filled(page, "ladder", tables.ladder_table(arrays))
    page = tables.filled(page, "slip", tables.ladder_table(slip))
    page = tables.filled(page, "balances", tables.balance_table([("arrays", arrays), ("slip", slip), ("mats", mats)]))
    page = tables.filled(page, "resolution", tables.resolution_table(resolution))
    page = tables.filled(page, "size", tables.size_table(sizes))
    drops = {name: read_records(RECORDS / f"{name}.csv", filters.Drop) for name in FILTERS}
    page = tables.filled(page, "filters", filters.drops_table(drops))
    PAGE.write_text(page, encoding="utf-8")
    save_figure(ladder_figure([*arrays, *slip]), GALLERY / "verification_arrays.svg")
    save_figure(mats_figure(resolution, sizes), GALLERY / "verification_mats.svg")


if __name__ == "__main__":
    for part in sys.argv[2:] or PARTS:
        if part == "page":
            write_page()
        else:
            measure(part, Path(sys.argv[1]))
