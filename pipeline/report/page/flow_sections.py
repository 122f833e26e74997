"""The sections of what the models say and what was solved: pressure drop, flow, efficiency."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

from pipeline.analytics.models.prediction import filter_of_mat, predict
from pipeline.analytics.models.single_fiber import PRESETS
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.analytics.sureness import sureness
from pipeline.analytics.tables.rows import comparison_tables, length, prediction_tables
from pipeline.line.results import Results
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.convergence import ConvergedDrop, convergence_tables
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Settling, Solution, SolvingCost
from pipeline.nouns.mat_measures import MatMeasures
from pipeline.nouns.section import Charts, Columns, Facts, Part, Picture, Pictures, Section, Table, Text
from pipeline.report.page import charts, words
from pipeline.report.page.converged import read_convergence
from pipeline.report.page.headline import wall_of

_WIDE = 4  # columns of a table from which it takes the width of the page


def comparison(content: Results) -> Section | None:
    """Show the models' pressure drops, and the solved one among them."""
    found = content.get(Comparison)
    if found is None:
        return None
    solution = content.get(Solution)
    facts = (
        ("face velocity", f"{100 * found.face_velocity:.4g} cm/s"),
        ("thickness", length(found.thickness)),
        ("fiber diameter that keeps length and volume", length(found.fiber_diameter)),
        ("Knudsen number of the fiber", f"{found.knudsen:.3g} ({found.regime} flow)"),
        ("Reynolds number of the fiber", f"{found.reynolds:.3g}"),
    )
    caption = (
        "By every model, from the three solidities: as the fibers were laid, as they were united, as they were meshed."
    )
    parts: list[Part] = [Charts((charts.models_chart(found, solution),), caption, wide=True), Facts(facts)]
    parts += comparison_tables(found)
    if solution is None:
        parts.append(Text("The flow has not been solved in this run.", "soft"))
    return Section("comparison", "Pressure drop", "Pressure drop", tuple(parts))


def solution(content: Results) -> Section | None:
    """Show the solved flow, and hold the models against it."""
    s, found = content.get(Solution), content.get(Comparison)
    if s is None:
        return None
    converged = read_convergence(content.folder)
    facts = [
        ("pressure drop", f"{s.pressure_drop:.4g} Pa, {wall_of(s.fiber_wall)}"),
        *_both_walls(s),
        ("permeability of the mat", f"{1e12 * s.permeability:.4g} µm²"),
        ("drag on the fibers", f"{1e9 * s.drag:.4g} nN"),
        ("flow rate", f"{1e9 * s.flow_rate:.4g} mm³/s"),
        ("forces and mass balance to", f"{abs(s.force_balance_error):.1g} and {abs(s.mass_balance_error):.1g}"),
        ("iterations", f"{s.iterations:,}, {'settled' if s.converged else 'not settled'}"),
    ]
    cost = content.get(SolvingCost)
    if cost is not None:
        time = f"{cost.seconds:.3g} s on {cost.cores} core{'s' if cost.cores > 1 else ''}"
        facts.append(("solver and time", f"{s.engine}, {time}"))
    if s.reynolds is not None and s.knudsen is not None:
        facts.insert(3, ("Knudsen number", f"{s.knudsen:.2g} ({s.regime} flow)"))
        facts.insert(3, ("fiber Reynolds number", f"{s.reynolds:.2g}, {s.inertia_words}"))
    if s.wall_edges:
        curved = 1.0 - (s.straight_wall_edges or 0) / s.wall_edges
        facts.append(("edges on walls that lie on the true fibers", f"{curved:.0%}"))
    if s.effective_fiber_diameter is not None:
        facts.append(("fiber diameter with which the chosen model agrees", length(s.effective_fiber_diameter)))
    if s.f_star is not None:
        facts.append(("drag per length over viscosity and velocity, F*", f"{s.f_star:.5g}"))
    parts: list[Part] = [Facts(tuple(facts)), Text(_what_is_known(s, converged), "note")]
    if converged is not None:
        parts += convergence_tables(converged)
    parts.append(
        Pictures(
            (
                Picture("flow", "Streamlines between the fibers, air from below."),
                Picture("flow-slice", "Speed and pressure on a plane along the flow, air from below."),
            )
        )
    )
    drawn, told = [], []
    if s.drag_per_fiber:
        drawn.append(charts.drag_chart(s))
        told.append("Drag of each fiber along the flow, in the order of mat/fibers.csv.")
    settling = content.get(Settling)
    if settling is not None:
        drawn.append(charts.settling_chart(settling))
        told.append("How far the pressure drop was from where it settled.")
    if drawn:
        parts.append(Charts(tuple(drawn), " ".join(told)))
    if found is not None:
        against = tuple(
            (row.title or name, words.finite(row.mesh), f"{row.mesh / s.pressure_drop - 1:+.1%}")
            for name, row in found.models.items()
            if math.isfinite(row.mesh)
        )
        parts.append(Table("", ("model", "Pa from the mesh's solidity", "against CFD"), against))
        parts += _outside_the_models(s, found)
    return Section("solution", "Flow", "Solved flow", tuple(parts))


def _both_walls(s: Solution) -> list[tuple[str, str]]:
    if s.pressure_drop_slip is None or s.pressure_drop_no_slip is None:
        return []
    more = s.pressure_drop_no_slip / s.pressure_drop_slip - 1.0
    both = f"{s.pressure_drop_no_slip:.4g} Pa and {s.pressure_drop_slip:.4g} Pa: {more:+.1%} ({s.other_wall})"
    return [("without and with slip", both)]


def _what_is_known(s: Solution, converged: ConvergedDrop | None) -> str:
    if converged is not None:
        drop = converged.pressure_drop
        return (
            f"On three meshes: {drop.value:.4g} Pa, between {drop.low:.4g} and {drop.high:.4g} Pa. The tables say what "
            "the mesh, slip, the box and the seed change."
        )
    settled = "" if s.pressure_drop_error is None else f" The iterations leave {s.pressure_drop_error:.0e} of it."
    return (
        f"{sureness(s)}.{settled} fibertwin converge solves this mat on three meshes and gives the number with its own "
        "interval."
    )


def _outside_the_models(s: Solution, found: Comparison) -> list[Part]:
    """Say so where the solved drop leaves the band of the models that are in their range, and why it may."""
    inside = [row.mesh for row in found.models.values() if math.isfinite(row.mesh) and not row.notes]
    if not inside or min(inside) <= s.pressure_drop <= max(inside):
        return []
    side = "below" if s.pressure_drop < min(inside) else "above"
    return [
        Text(
            f"The solved drop lies {side} what the models in their range say, {min(inside):.3g} to "
            f"{max(inside):.3g} Pa. "
            "A small box, fibers that are denser at the frame of the plan than in its middle, and one seed may each do "
            "that; where a finer mesh or another seed does not bring it back, do not trust it.",
            "note",
        )
    ]


def prediction(content: Results) -> Section | None:
    """Show the efficiency by the single-fiber model."""
    found, flow = content.get(Comparison), content.case.flow
    mat, measures = content.get(Mat), content.get(MatMeasures)
    if found is not None:
        medium, basis = (
            FilterSettings(
                solidity=found.solidity["mesh"], thickness=found.thickness, fiber_diameter=found.fiber_diameter
            ),
            "the solidity of the mesh",
        )
    elif mat is not None and measures is not None and measures.solidity < 1.0:
        medium, basis = filter_of_mat(mat, flow.flow()), "the nominal solidity of the mat"
    else:
        return None
    tables = prediction_tables(predict(medium, flow))
    # the comparison has the pressure drops already
    shown = tables if found is None else tuple(table for table in tables if table.title != "Pressure drop")
    narrow = tuple((table,) for table in shown if len(table.columns) < _WIDE)
    wide = [table for table in shown if len(table.columns) >= _WIDE]
    drawn = Charts(tuple(charts.prediction_charts(medium, flow)))
    basis_of = f"From {basis}. {_bend(medium, flow)}"
    parts: tuple[Part, ...] = (Text(basis_of.strip(), "soft"), drawn, Columns(narrow, even=True), *wide)
    return Section("prediction", "Efficiency", "Efficiency by the single-fiber model", parts)


def _bend(medium: FilterSettings, flow: FlowSettings) -> str:
    """Explain the bend that impaction puts into the curves."""
    cutoff = PRESETS[flow.preset].impaction_cutoff
    if not math.isfinite(cutoff):
        return ""
    place = length(cutoff * medium.fiber_diameter)
    return f"The curves bend at {place}, {cutoff:g} fiber diameters: from there on impaction's J is 2.0, after Hinds."
