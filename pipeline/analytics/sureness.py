"""How far to trust a solved pressure drop, in one sentence."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.nouns.flow import Solution


def known_errors(solution: Solution) -> list[tuple[str, str]]:
    """Give what moves the pressure drop, and by how much, as far as one solution knows.

    Examples
    --------
    >>> known_errors(Solution(7.5, 1e-8, 1e-9, 1e-12, 0.0, 0.0, 30, True, mesh_error=(0.013, 0.008, 0.02)))
    [('this mesh', '+1.3 % (+0.8 to +2.0 %, measured on other mats)')]
    """
    found = []
    if solution.mesh_error is None:
        found.append(("this mesh", "not measured (fibertwin converge does)"))
    else:
        mean, low, high = (f"{100.0 * value:+.1f}" for value in solution.mesh_error)
        found.append(("this mesh", f"{mean} % ({low} to {high} %, measured on other mats)"))
    if solution.pressure_drop_slip is not None and solution.pressure_drop_no_slip is not None:
        slips = solution.fiber_wall == "slip"
        drop = solution.pressure_drop_no_slip if slips else solution.pressure_drop_slip
        change = f"{100.0 * (drop / solution.pressure_drop - 1.0):+.0f} %"
        found.append(("no slip would be" if slips else "slip would be", change))
    if solution.seed_spread is not None:
        found.append(("another seed", f"±{100.0 * solution.seed_spread:.0f} % (one standard deviation)"))
    return found


def sureness(solution: Solution) -> str:
    """Say it in one sentence.

    Examples
    --------
    >>> sureness(Solution(7.5, 1e-8, 1e-9, 1e-12, 0.0, 0.0, 30, True, seed_spread=0.15))
    '7.5 Pa; this mesh not measured (fibertwin converge does), another seed ±15 % (one standard deviation)'
    """
    return f"{solution.pressure_drop:.3g} Pa; " + ", ".join(
        f"{what} {change}" for what, change in known_errors(solution)
    )
