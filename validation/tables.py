"""The measured figures as tables in Markdown, put between a page's marks."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence

from pipeline.errors import StageError
from validation.judged import Judged, judged
from validation.ladder import Rung
from validation.lattices import LatticeRung
from validation.mats import MatRun, mean_and_half_width, over_finest, spread


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
    return [
        *(f"{_percent(rung.error)} ({rung.cells:,})" for rung in each.rungs),
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


def resolution_table(runs: list[MatRun]) -> str:
    """Pressure drop of the same mats on three meshes."""
    over = dict(over_finest(runs))
    rows = []
    for edge, group in reversed(spread(runs, "edge")):
        rows.append(
            [
                f"{edge:g}",
                f"{sum(each.cells for each in group) // len(group):,}",
                *(f"{each.cfd:.3f}" for each in group),
                _with_width([100.0 * (value - 1.0) for value in over[edge]], "%", signed=True),
            ]
        )
    seeds = [f"seed {each.seed} [Pa]" for each in spread(runs, "edge")[0][1]]
    return table(["edge [diameters]", "cells (mean)", *seeds, "against the finest"], rows)


def size_table(runs: list[MatRun]) -> str:
    """Pressure drop of mats in boxes of several sides."""
    rows = []
    for side, group in spread(runs, "side"):
        rows.append(
            [
                f"{1e6 * side:g} um",
                f"{sum(each.fibers for each in group) / len(group):.1f}",
                _with_width([100.0 * each.solidity for each in group], "%"),
                _with_width([each.cfd for each in group], "Pa"),
                _with_width([each.cfd / each.davies for each in group], ""),
            ]
        )
    return table(["side", "fibers (mean)", "solidity of the mesh", "CFD", "CFD over Davies"], rows)


def _percent(value: float) -> str:
    return f"{100.0 * value:+.2f} %"


def _order(order: float) -> str:
    return "swings" if math.isnan(order) else f"{order:.1f}"


def _with_width(values: list[float], unit: str, signed: bool = False) -> str:
    mean, half = mean_and_half_width(values)
    return f"{mean:{'+' if signed else ''}.3g} ± {half:.2g} {unit}".strip()
