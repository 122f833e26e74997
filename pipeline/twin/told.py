"""A twin in words and in numbers: what of the measured it has, what it has not, and what it would take."""

# SPDX-License-Identifier: GPL-3.0-or-later

import textwrap
from typing import Any

from pipeline.design.targets import readable
from pipeline.nouns.section import Table
from pipeline.twin.match import Twin

_WIDTH = 110
_ORDER = ("fiber_diameter", "basis_weight", "solidity", "thickness", "pressure_drop")


def table_of(twin: Twin) -> Table:
    """Give what was measured beside what the twin has."""
    rows = []
    for name in (name for name in _ORDER if name in twin.values):
        told = twin.measured.get(name)
        rows.append(
            (
                words(name, twin),
                "" if told is None else readable(name, told.value),
                "" if told is None else f"{readable(name, told.low)} to {readable(name, told.high)}",
                readable(name, twin.values[name]),
                "" if told is None else ("no" if name in twin.unmatched else "yes"),
                readable(name, twin.spread[name]),
            )
        )
    return Table(
        f"the twin: {twin.count} fibers, seed {twin.choice.seed}",
        ("", "measured", "within", "twin", "matched", "std of one mat"),
        tuple(rows),
    )


def words(name: str, twin: Twin) -> str:
    """Name a quantity for people."""
    match name:
        case "fiber_diameter":
            return "mean fiber diameter"
        case "pressure_drop":
            how = "solved" if twin.drop_by == "solve" else f"by the model {twin.drop_by}"
            return f"pressure drop, {how}"
    return name.replace("_", " ")


def notes(twin: Twin) -> list[str]:
    """Say what cannot be matched, what is nearest, and what it would take."""
    found = [
        f"{words(name, twin)} cannot be matched: {readable(name, twin.measured[name].value)} was measured, and the "
        f"nearest is {readable(name, twin.values[name])}"
        for name in twin.unmatched
    ]
    if twin.unmatched and twin.alone:
        others = [f"{words(name, twin)} {readable(name, value)}" for name, value in twin.alone.items()]
        found.append(f"all else would be within its tolerance with {', or '.join(others)}")
    elif len(twin.unmatched) > 1:
        found.append("what was measured contradicts itself: no single quantity is to blame")
    low, high = twin.reach
    if twin.unmatched and high < 1:
        tighter = '; contact = "paper" lets fibers overlap, and packs them tighter' if twin.contact == "clear" else ""
        found.append(f"mats of these fibers have solidities of up to {readable('solidity', high)}{tighter}")
    if twin.unmatched and low > 0:
        found.append(f"mats of these fibers have solidities from {readable('solidity', low)} on")
    uneven = [name for name, each in twin.measured.items() if twin.spread[name] > each.tolerance]
    if uneven:
        found.append(
            f"chance moves {', '.join(words(name, twin) for name in uneven)} of mats of "
            f"{readable('thickness', twin.side)} on a side by more than the tolerance: other seeds are no twins; a "
            "larger side evens it out"
        )
    return found


def head_of(twin: Twin) -> str:
    """Write the comment at the top of its case file."""
    has = [
        f"{words(name, twin)} {readable(name, twin.values[name])} (measured {readable(name, each.value)})"
        for name, each in twin.measured.items()
    ]
    opening = f"The twin of a filter with {twin.fibers.origin}: {', '.join(has)}."
    return "\n".join([*textwrap.wrap(opening, _WIDTH), "Which flow goes with what was measured?"])


def numbers(twin: Twin) -> dict[str, Any]:
    """Give the twin as JSON-able content in SI units."""
    quantities: dict[str, Any] = {}
    for name in (name for name in _ORDER if name in twin.values):
        told = twin.measured.get(name)
        beside = {"twin": twin.values[name], "std": twin.spread[name]}
        if told is not None:
            beside = {"measured": told.value, "low": told.low, "high": told.high, **beside}
            beside["within"] = name not in twin.unmatched
        quantities[name] = beside
    return {
        "matched": not twin.unmatched,
        "unmatched": list(twin.unmatched),
        "quantities": quantities,
        "would_match": twin.alone,
        "solidity_reach": list(twin.reach),
        "pressure_drop_by": twin.drop_by,
        "relaxation_slope": twin.choice.place[0],
        "spacing": twin.choice.place[1],
        "coverage": twin.choice.coverage,
        "diameter_scale": twin.choice.scale,
        "side": twin.side,
        "fibers": twin.count,
        "seed": twin.choice.seed,
        "notes": notes(twin),
    }
