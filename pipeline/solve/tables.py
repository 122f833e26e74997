"""A solution as a table for the terminal."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

from pipeline.analytics.sureness import known_errors
from pipeline.analytics.tables.rows import length
from pipeline.nouns.flow import Solution, SolvingCost
from pipeline.nouns.section import Table
from pipeline.units import duration

if TYPE_CHECKING:
    from pipeline.line.results import Results


def tables(results: "Results") -> tuple[Table, ...]:
    """Give the table of the flow."""
    return (solution_table(results.read(Solution), results.read(SolvingCost)),)


def solution_table(solution: Solution, cost: SolvingCost) -> Table:
    """Lay a solution out in the units people use."""
    rows = [
        ("pressure drop", f"{solution.pressure_drop:.4g} Pa"),
        *known_errors(solution),
        ("flow rate", f"{solution.flow_rate * 1e9:.4g} mm3/s"),
        ("drag on the fibers", f"{solution.drag * 1e9:.4g} nN"),
        ("permeability", f"{solution.permeability * 1e12:.4g} um2"),
    ]
    if solution.effective_fiber_diameter is not None:
        rows.append(("effective fiber diameter", length(solution.effective_fiber_diameter)))
    if solution.f_star is not None:
        rows.append(("drag per length F*", f"{solution.f_star:.5g}"))
    if solution.reynolds is not None:
        rows.append(("fiber Reynolds number", f"{solution.reynolds:.2g}, {solution.inertia_words}"))
    settled = "settled" if solution.converged else f"NOT settled: raise solve.{solution.engine}.max_iterations"
    rows += [
        ("iterations", f"{solution.iterations:,}, {settled}"),
        ("forces balance to", f"{abs(solution.force_balance_error):.2g}"),
        ("mass balances to", f"{abs(solution.mass_balance_error):.2g}"),
        ("time", f"{duration(cost.seconds)} on {cost.cores} core{'s' if cost.cores > 1 else ''}"),
    ]
    return Table("solution", ("", ""), tuple(rows))
