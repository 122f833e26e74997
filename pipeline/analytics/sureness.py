"""How far to trust a solved pressure drop, in one sentence."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.nouns.flow import Solution


def sureness(solution: Solution) -> str:
    """Say what the mesh leaves, what the other wall would give, and what another seed would.

    Examples
    --------
    >>> sureness(Solution(7.5, 1e-8, 1e-9, 1e-12, 0.0, 0.0, 30, True, mesh_error=(0.013, 0.008, 0.02)))
    '7.5 Pa; this mesh +1.3 % (+0.8 to +2.0 %, measured on other mats)'
    """
    parts = []
    if solution.mesh_error is not None:
        mean, low, high = (f"{100.0 * value:+.1f}" for value in solution.mesh_error)
        parts.append(f"this mesh {mean} % ({low} to {high} %, measured on other mats)")
    else:
        parts.append("what this mesh leaves was not measured (fibertwin converge does)")
    if solution.pressure_drop_slip is not None and solution.pressure_drop_no_slip is not None:
        other = "no_slip" if solution.fiber_wall == "slip" else "slip"
        drop = solution.pressure_drop_no_slip if other == "no_slip" else solution.pressure_drop_slip
        words = "no slip would be" if other == "no_slip" else "slip would be"
        parts.append(f"{words} {100.0 * (drop / solution.pressure_drop - 1.0):+.0f} %")
    if solution.seed_spread is not None:
        parts.append(f"another seed ±{100.0 * solution.seed_spread:.0f} % (one standard deviation)")
    return f"{solution.pressure_drop:.3g} Pa; " + ", ".join(parts)
