"""A converged pressure drop as tables."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.nouns.convergence import ConvergedDrop
from pipeline.nouns.section import Table


def convergence_tables(found: ConvergedDrop) -> tuple[Table, Table]:
    """Give the meshes and what moves the number, in the units people use."""
    meshes = tuple(
        (
            f"{rung.edge:.3g}",
            f"{rung.cells:,}",
            f"{rung.pressure_drop:.4g}",
            "" if rung.pressure_drop_no_slip is None else f"{rung.pressure_drop_no_slip:.4g}",
            "" if rung.pressure_drop_slip is None else f"{rung.pressure_drop_slip:.4g}",
            f"{rung.seconds:.3g}",
        )
        for rung in found.rungs
    )
    drop, parts = found.pressure_drop, found.contributions
    count = f"1 sd, {len(found.seeds)} seeds"
    rows = [
        ("pressure drop", f"{drop.value:.4g} Pa, {drop.low:.4g} to {drop.high:.4g} Pa"),
        ("observed order", "none: the meshes differ by chance" if found.order is None else f"{found.order:.2g}"),
        ("this case's mesh", f"{parts.mesh:+.1%}"),
        ("no slip would be", "not solved" if parts.slip is None else f"{parts.slip:+.1%}"),
        ("a larger box", "not drawn" if parts.box is None else f"{parts.box:+.1%}"),
        ("another seed", "not solved; --seeds K does" if parts.seed is None else f"{parts.seed:.1%} ({count})"),
    ]
    rows += [("not known", note) for note in found.notes]
    return (
        Table("meshes", ("edge", "cells", "Pa", "Pa, no slip", "Pa, slip", "s"), meshes),
        Table("pressure drop and what moves it", ("", ""), tuple(rows)),
    )
