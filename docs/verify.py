"""Measure what docs/verification.md shows, and write its tables and plots: ``make verify``.

``python docs/verify.py RUNS [PART ...]`` runs some parts only: arrays, lattices, mats, and
page, which writes tables and plots from what the others left in docs/verification. Finished runs are reused.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.analytics.measured_errors import Measured, write_measured
from pipeline.analytics.tables.plots import save_figure
from pipeline.case import read_case
from validation import tables
from validation.ladder import CLIMBS, Rung, ladder
from validation.lattices import LatticeRung, lattices
from validation.mats import MatRun, edge_errors, mat_runs, of_seeds
from validation.plots import cost_figure, ladder_figure
from validation.records import read_records, write_records

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

DOCS = Path(__file__).parent
PAGE, RECORDS, GALLERY = DOCS / "verification.md", DOCS / "verification", DOCS / "gallery"
CASES = DOCS.parent / "cases"
ARRAYS = ("square", "hexagonal")
PARTS = ("arrays", "lattices", "mats", "page")


def told(what: str, done: float | None = None) -> None:
    """Say which stages are done."""
    if done == 1.0:
        sys.stderr.write(f"{what}\n")


def measure(part: str, runs: Path) -> None:
    """Run a part's cases and keep their figures."""
    if part == "arrays":
        cases = {name: read_case(CASES / "verification" / f"{name}.toml") for name in ARRAYS}
        jobs = [job for each in CLIMBS for job in ladder(cases[each.arrangement], runs / part, each, told)]
        collect(part, runs, jobs, Rung)
    elif part == "lattices":
        collect(part, runs, list(lattices(runs / part, progress=told)), LatticeRung)
    elif part == "mats":
        case = read_case(CASES / "verification" / "mat.toml")
        collect(part, runs, list(mat_runs(case, runs / part, told)), MatRun)


def collect(part: str, runs: Path, jobs: "Sequence[Callable[[], DataclassInstance]]", kind: type) -> None:
    """Do jobs one by one, and keep what they found; what an interrupted call found is not done again."""
    kept = runs / f"{part}.csv"
    found = read_records(kept, kind) if kept.is_file() else []
    for job in jobs[len(found) :]:
        found.append(job())
        write_records(kept, found)
    write_records(RECORDS / kept.name, found)


def write_page() -> None:
    """Fill the page's tables and draw its plots."""
    page = PAGE.read_text(encoding="utf-8")
    arrays = read_records(RECORDS / "arrays.csv", Rung)
    lattice = read_records(RECORDS / "lattices.csv", LatticeRung)
    usual = [rung for rung in arrays if (rung.mesher, rung.engine) == ("tetwild", "stokes")]
    page = tables.filled(page, "arrays", tables.ladder_table([rung for rung in usual if rung.slip == 0.0]))
    page = tables.filled(page, "slip", tables.ladder_table([rung for rung in usual if rung.slip > 0.0]))
    page = tables.filled(page, "others", tables.ladder_table([rung for rung in arrays if rung not in usual]))
    page = tables.filled(page, "lattices", tables.lattice_table(lattice))
    elements = [rung for rung in arrays if rung.engine == "stokes"]
    volumes = [rung for rung in arrays if rung.engine == "openfoam"]
    balances = [("arrays, elements", elements), ("lattices, elements", lattice), ("arrays, simpleFoam", volumes)]
    page = tables.filled(page, "balances", tables.balance_table([each for each in balances if each[1]]))
    mats = read_records(RECORDS / "mats.csv", MatRun)
    errors = edge_errors(mats)
    page = tables.filled(page, "edges", tables.edges_table(errors))
    page = tables.filled(page, "time to one percent", tables.time_table(errors))
    page = tables.filled(page, "agreement", tables.agreement_table(mats, errors))
    seeds = of_seeds(mats, read_case(CASES / "verification" / "mat.toml"))
    write_measured(Measured("docs/verification.md, by make verify", tuple(errors), seeds))
    save_figure(cost_figure(errors), GALLERY / "verification_cost.svg")
    PAGE.write_text(page, encoding="utf-8")
    save_figure(ladder_figure(arrays, lattice), GALLERY / "verification_arrays.svg")


if __name__ == "__main__":
    for part in sys.argv[2:] or PARTS:
        if part == "page":
            write_page()
        else:
            measure(part, Path(sys.argv[1]))
