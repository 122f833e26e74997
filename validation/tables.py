"""The measured figures as tables in Markdown, put between a page's marks."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence

from pipeline.analytics.measured_errors import EdgeError, Need, needed_edge
from pipeline.errors import StageError
from validation.judged import Judged, judged
from validation.ladder import Rung
from validation.lattices import LatticeRung
from validation.mats import USUAL, MatRun

SOLVERS = {"stokes": "elements", "openfoam": "simpleFoam"}
ASKED = (0.05, 0.02, 0.01)
"""Errors whose cost is told."""


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Give a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def filled(page: str, name: str, content: str) -> str:
    r"""Put content between ``<!-- name -->`` and ``<!-- end of name -->``.

    Raises
    ------
    StageError
        If the page has no such marks.

    Examples
    --------
    >>> filled("a <!-- t --> old <!-- end of t --> b", "t", "new")
    'a <!-- t -->\n\nnew\n\n<!-- end of t --> b'
    """
    start, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    before, opened, rest = page.partition(start)
    _, closed, after = rest.partition(end)
    if not opened or not closed:
        raise StageError(f"the page has no place for {name}: put {start} and {end} where it goes")
    return f"{before}{start}\n\n{content}\n\n{end}{after}"


def lattice_table(rungs: list[LatticeRung]) -> str:
    """Resistance of lattices on three meshes against the exact one."""
    rows = [
        [each.fine.lattice, f"{each.fine.solidity:g}", each.fine.mesher, f"{each.fine.exact:.5g}", *_of_three(each)]
        for each in judged(rungs)
    ]
    return table(["lattice", "solidity", "mesher", "exact k/a2", *_HEADS], rows)


def ladder_table(rungs: list[Rung]) -> str:
    """Drag on three meshes against the exact one."""
    rows = []
    for each in judged(rungs):
        fine = each.fine
        whose = [fine.arrangement, f"{fine.solidity:g}", f"{fine.slip:g}", fine.mesher, fine.engine]
        rows.append([*whose, f"{fine.exact:.3f}", *_of_three(each)])
    return table(["array", "solidity", "slip", "mesher", "solver", "exact F*", *_HEADS], rows)


_HEADS = ("coarse (cells)", "middle", "fine", "order", "observed", "extrapolated", "GCI")


def _of_three(each: Judged[Rung] | Judged[LatticeRung]) -> list[str]:
    found = each.found
    errors = [f"{_percent(rung.error)} ({rung.cells:,})" for rung in each.rungs]
    if found is None:
        return [*errors, _order(each.order), "", "", ""]
    return [
        *errors,
        _order(each.order),
        _order(found.order),
        _percent(found.extrapolated - 1.0),
        f"{100.0 * found.index:.2f} %",
    ]


def balance_table(groups: Sequence[tuple[str, Sequence[Rung] | Sequence[LatticeRung]]]) -> str:
    """Worst force and mass balance, and the effort, of each group of runs."""
    rows = []
    for name, runs in groups:
        rows.append(
            [
                name,
                str(len(runs)),
                f"{max(abs(each.force_balance) for each in runs):.1e}",
                f"{max(abs(each.mass_balance) for each in runs):.1e}",
                f"{min(each.iterations for each in runs)} to {max(each.iterations for each in runs)}",
                f"{sum(each.processor_seconds for each in runs) / 60:.1f} min",
            ]
        )
    head = ["runs", "number", "forces, worst", "mass, worst", "iterations", "processor time"]
    return table(head, rows)


def edges_table(found: Sequence[EdgeError]) -> str:
    """Error and cost of random mats by mesher, solver and edge."""
    rows = [
        [
            each.mesher,
            SOLVERS[each.solver],
            f"{each.edge:g}",
            f"{each.growth:g}",
            f"{100.0 * each.mean:+.1f} % ({100.0 * each.low:+.1f} to {100.0 * each.high:+.1f} %)",
            str(each.mats),
            f"{each.cells:.0f}",
            f"{1e3 * each.seconds:.0f} ms",
        ]
        for each in found
    ]
    head = [
        "mesher",
        "solver",
        "edge [d]",
        "growth",
        "error, mean (range)",
        "mats",
        "cells per d of fiber",
        "time per d of fiber",
    ]
    return table(head, rows)


def time_table(found: Sequence[EdgeError]) -> str:
    """Tell what 5, 2 and 1 % cost with each mesher and solver, by the trend of what was measured."""
    rows = []
    for mesher, solver in dict.fromkeys((each.mesher, each.solver) for each in found):
        needs = [needed_edge(mesher, solver, error, found) for error in ASKED]
        rows.append([mesher, SOLVERS[solver], *("not known" if each is None else _need(each) for each in needs)])
    return table(["mesher", "solver", *(f"{100.0 * error:.0f} %" for error in ASKED)], rows)


def _need(need: Need) -> str:
    trend = "" if need.measured else " (trend)"
    return f"edge {need.edge:.2f}, growth {need.growth:.2f}: {need.cells:,.0f} cells, {need.seconds:.2g} s{trend}"


def agreement_table(runs: Sequence[MatRun], found: Sequence[EdgeError]) -> str:
    """Show mats by both meshers and both solvers on the usual mesh, and how far they are apart less their errors."""
    mean = {(each.mesher, each.solver): each.mean for each in found if (each.edge, each.growth) == (USUAL, 1.0)}
    rows = []
    for seed in sorted({each.seed for each in runs}):
        of_mesher = {each.mesher: each for each in runs if (each.seed, each.edge) == (seed, USUAL)}
        if not {"tetwild", "lattice"} <= of_mesher.keys():
            continue
        truest, lattice = of_mesher["tetwild"], of_mesher["lattice"]
        drops = {
            ("tetwild", "stokes"): truest.elements,
            ("lattice", "stokes"): lattice.elements,
            ("tetwild", "openfoam"): truest.volumes,
        }
        less = [drop / (1.0 + mean[key]) for key, drop in drops.items()]
        rows.append(
            [
                str(seed),
                f"{truest.elements:.3f}",
                f"{lattice.elements:.3f} ({_percent(lattice.elements / truest.elements - 1.0)})",
                f"{truest.volumes:.3f} ({_percent(truest.volumes / truest.elements - 1.0)})",
                f"{_percent(less[1] / less[0] - 1.0)}",
                f"{_percent(less[2] / less[0] - 1.0)}",
            ]
        )
    head = [
        "seed", "fTetWild, elements [Pa]", "lattice, elements", "fTetWild, simpleFoam",
        "less mean errors: lattice", "simpleFoam",
    ]  # fmt: skip
    return table(head, rows)


def _percent(value: float) -> str:
    return f"{100.0 * value:+.2f} %"


def _order(order: float) -> str:
    return "swings" if math.isnan(order) else f"{order:.1f}"
