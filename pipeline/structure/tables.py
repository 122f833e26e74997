"""The pores as a table for the terminal and the page."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

from pipeline.analytics.tables.rows import length
from pipeline.nouns.section import Table
from pipeline.nouns.structure import Structure

if TYPE_CHECKING:
    from pipeline.line.results import Results


def tables(results: "Results") -> tuple[Table, ...]:
    """Give the table of the pores."""
    return (Table("structure", ("", ""), structure_rows(results.read(Structure))),)


def structure_rows(found: Structure) -> tuple[tuple[str, str], ...]:
    """Lay a structure out in the units people use."""
    pores = found.pores
    rows = [
        ("mean pore", f"{length(pores.mean)}, spread {length(pores.std)}, by the spheres that fit in"),
        (
            "median pore",
            f"{length(pores.median)}; tenths below {length(pores.p10)}, above {length(pores.p90)}",
        ),
        ("largest pore", length(pores.largest)),
        ("bubble point", length(found.bubble_point) if found.bubble_point else "none: no sphere passes"),
        ("mean flow pore", length(found.mean_flow_pore) if found.mean_flow_pore else "none: nothing passes"),
        (
            "tortuosity",
            f"{found.tortuosity:.4g}, diffusive: a gas spreads {found.relative_diffusivity:.4g} as fast as in free air",
        ),
    ]
    area = found.specific_surface
    if area is not None:
        by_mass = "" if area.per_mass is None else f", {1e-3 * area.per_mass:.4g} m2/g"
        rows.append(("specific surface", f"{area.per_volume:.4g} m2/m3{by_mass}"))
    return tuple(rows)
