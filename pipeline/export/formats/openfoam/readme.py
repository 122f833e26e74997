"""The README of a written case: how to run it, what its pressures are, and what finite volumes leave on its mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.analytics.measured_errors import EdgeError, measured, mesh_error, needed_edge

_ASKED = (0.05, 0.02, 0.01)


def format_readme(density: float, slip: bool, mesher: str | None, edge: float | None, growth: float = 1.0) -> str:
    """Write the text.

    Parameters
    ----------
    density : float [kg/m3]
        Of the air.
    slip : bool
        Whether the air slips along the fibers.
    mesher : str or None
        As ``tetmesh.engine`` names it; None for a mesh of unknown making.
    edge : float [-] or None
        At the fibers, in fiber diameters.
    growth : float [-]
        How much longer edges become per distance from the fibers.
    """
    wall = "The air slips along the fibers." if slip else "The air stands still on the fibers."
    lines = [
        "# A case for OpenFOAM, written by fibertwin",
        "",
        "`./Allrun [cores]` checks the mesh, runs the solver and tells the pressure drop in Pa.",
        f"Pressures in the fields are over the air's density, {density:.4g} kg/m3: m2/s2, not Pa.",
        wall,
        "",
        "## How far to trust finite volumes here",
        "",
        *_trust(mesher, edge, growth),
    ]
    return "\n".join(lines) + "\n"


def _trust(mesher: str | None, edge: float | None, growth: float) -> list[str]:
    if mesher is None or edge is None:
        return ["What the mesh leaves is not known: solve on a finer one, and compare."]
    mesh = f"`tetmesh.engine = {mesher}`, `edge = {edge:g}`, `growth = {growth:g}`"
    lines = []
    here = mesh_error(mesher, "openfoam", edge, growth)
    if here is None:
        lines.append(f"What simpleFoam leaves on such a mesh ({mesh}) was not measured.")
    else:
        lines.append(f"On such a mesh ({mesh}) simpleFoam's pressure drop was {_told(here)}.")
    elements = mesh_error(mesher, "stokes", edge, growth)
    if elements is not None:
        lines.append(f"Second-order elements (`solve.engine = stokes`) were {_told(elements)}.")
    for error in _ASKED:
        need = needed_edge(mesher, "openfoam", error)
        if need is not None:
            mesh = f"`tetmesh.edge = {need.edge:.2g}` with `tetmesh.growth = {need.growth:.2g}`"
            trend = "." if need.measured else ", by the trend: no such mesh was measured."
            lines.append(
                f"- {100 * error:.0f} % need {mesh}: {_rounded(need.cells)} cells and {need.seconds:.2g} s of "
                f"processor time per fiber diameter of fiber length{trend}"
            )
    return [*lines, "", f"Measured: {measured().source}."]


def _told(found: EdgeError) -> str:
    low, high = (f"{100 * value:+.1f}" for value in (found.low, found.high))
    return f"{100 * found.mean:+.1f} % off on average, {low} to {high} % on {found.mats} small mats"


def _rounded(value: float) -> str:
    return f"{float(f'{value:.2g}'):,.0f}"
