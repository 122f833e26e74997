"""What was caught as tables for the terminal and the page."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

from pipeline.analytics.formulas.classes import ISO_16890
from pipeline.nouns.capture import Capture, MostPenetratingSize
from pipeline.nouns.section import Table

if TYPE_CHECKING:
    from pipeline.line.results import Results


def tables(results: "Results") -> tuple[Table, ...]:
    """Give the tables of what was caught."""
    return capture_tables(results.read(Capture))


def capture_tables(capture: Capture) -> tuple[Table, ...]:
    """Lay out efficiency over particle size, the worst size, and the classes that follow."""
    rows = []
    for k, diameter in enumerate(capture.particle_diameter):
        single, rare = capture.fiber_efficiency[k], capture.rare_penetration[k]
        passed = share(capture.penetration[k])
        if rare is not None:
            passed = f"{rare.penetration:.2g} ({rare.low:.2g} to {rare.high:.2g})"
        rows.append((
            size(diameter),
            share(capture.efficiency[k]),
            f"{share(capture.low[k])} to {share(capture.high[k])}",
            passed,
            "-" if single is None else f"{single:.3g}",
            share(capture.single_fiber[k]),
            f"{capture.released[k]:,}",
        ))  # fmt: skip
    heads = ("particle", "efficiency", "95 % interval", "penetration", "single fiber", "model", "particles")
    return Table("capture", heads, tuple(rows)), Table("filter", ("", ""), tuple(filter_rows(capture)))


def filter_rows(capture: Capture) -> list[tuple[str, str]]:
    """Say in filter people's words what the curve amounts to."""
    flow, model = capture.most_penetrating["cfd"], capture.most_penetrating["model"]
    rows = [
        ("most penetrating size (MPPS)", _worst(flow)),
        ("by the single-fiber model", f"{_worst(model)} over its presets"),
        ("class after EN 1822 at MPPS", _class(capture.en_1822, flow, "E10 (15 % penetration)")),
        ("class after ISO 29463 at MPPS", _class(capture.iso_29463, flow, "ISO 15 E (5 % penetration)")),
    ]
    groups = [f"{name} {share(value)}" for name, value in capture.iso_16890.items() if value is not None]
    missing = [name for name in ISO_16890 if capture.iso_16890.get(name) is None]
    if missing:
        groups.append(f"{', '.join(missing)}: sizes from 0.3 um to the group's largest are missing")
    rows.append(("efficiency by group, ISO 16890", "; ".join(groups)))
    if capture.iso_16890_group is not None:
        rows.append(("group after ISO 16890", capture.iso_16890_group))
    if any(capture.timed_out):
        rows.append(("given up before they had an end", f"{sum(capture.timed_out):,} particles"))
    rows.append(("paths of the air that end on a fiber", f"{share(capture.stray)}, by the error of mesh and flow"))
    return rows


def _worst(found: MostPenetratingSize) -> str:
    if not found.inside:
        return f"beyond the sizes looked at, near {size(found.diameter)}"
    return f"{size(found.diameter)} ({size(found.low)} to {size(found.high)}), penetration {share(found.penetration)}"


def _class(name: str | None, worst: MostPenetratingSize, lowest: str) -> str:
    if name is not None:
        return name
    return f"none, below {lowest}" if worst.inside else "not known: the worst size lies beyond those looked at"


def size(diameter: float) -> str:
    """Write a particle diameter as people do.

    Examples
    --------
    >>> size(3e-7), size(2.5e-6)
    ('300 nm', '2.5 um')
    """
    return f"{1e9 * diameter:.3g} nm" if diameter < 0.9995e-6 else f"{1e6 * diameter:.3g} um"


def share(value: float) -> str:
    """Write a share in percent, with the digits that tell it from nothing and from all.

    Examples
    --------
    >>> share(0.5), share(0.99995), share(2e-5), share(1.0)
    ('50 %', '99.995 %', '0.002 %', '100 %')
    """
    near = min(value, 1.0 - value)
    if near <= 0.0 or near >= 0.01:
        return f"{100 * value:.3g} %"
    digits = 2
    while digits < 10 and round(100 * near, digits) < 10.0 ** (1 - digits):
        digits += 1
    return f"{100 * value:.{digits}f}".rstrip("0").rstrip(".") + " %"
