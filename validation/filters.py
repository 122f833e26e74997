"""The solved pressure drop of a whole case beside those of all models."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pipeline.line.run import Run
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.flow import Solution
from pipeline.nouns.mesh_measures import TetmeshMeasures
from validation.tables import table

SOLVED = "cfd"


@dataclass(frozen=True, slots=True)
class Drop:
    """A pressure drop, by whom, and from what.

    Parameters
    ----------
    model : str
        Key of the model, or ``cfd``.
    title : str
        Whose it is; for ``cfd`` the mesh and the solver's checks.
    nominal, surface, mesh : float [Pa]
        From each solidity; for ``cfd`` all three are the one that was solved.
    remark : str
        What is outside the model's range.
    """

    model: str
    title: str
    nominal: float
    surface: float
    mesh: float
    remark: str


def pressure_drops(run: Run) -> list[Drop]:
    """Collect the solved pressure drop of a run and those of all models."""
    solution, comparison, measures = run.read(Solution), run.read(Comparison), run.read(TetmeshMeasures)
    own = (
        f"solved on {measures.cells:,} cells, {solution.iterations} iterations"
        f"{'' if solution.converged else ', not settled'}"
    )
    checks = f"forces to {abs(solution.force_balance_error):.1e}, mass to {abs(solution.mass_balance_error):.1e}"
    solidity = "solidity {nominal:.2%} nominal, {surface:.2%} surface, {mesh:.2%} mesh".format(**comparison.solidity)
    drop = solution.pressure_drop
    drops = [Drop(SOLVED, own, drop, drop, drop, f"{checks}; {solidity}")]
    for name, row in comparison.models.items():
        drops.append(Drop(name, row.title, row.nominal, row.surface, row.mesh, "; ".join(row.notes)))
    return drops


def drops_table(cases: Mapping[str, Sequence[Drop]]) -> str:
    """Give the pressure drops of several cases, models at the solidity of the mesh, each over the solved one."""
    found = {case: {each.model: each for each in drops} for case, drops in cases.items()}
    first = next(iter(found.values()))
    rows = []
    for name, drop in first.items():
        cells = []
        for by_model in found.values():
            solved, own = by_model[SOLVED].mesh, by_model[name].mesh
            cells.append(f"**{own:.3g} Pa**" if name == SOLVED else f"{own:.3g} Pa ({own / solved:.2f})")
        rows.append(["CFD" if name == SOLVED else drop.title, *cells])
    return table(["pressure drop", *(f"cases/{case}.toml" for case in found)], rows)
