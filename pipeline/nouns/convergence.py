"""What several meshes, walls, boxes and seeds tell of a pressure drop."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

from pipeline.nouns.section import Table

RESULT = "convergence.json"
"""File of a run's folder that holds what `fibertwin converge` found."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A value and the band that should hold the true one."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class MeshRung:
    """One mesh of three.

    Parameters
    ----------
    edge : float [-]
        Edge length at the fibers in mean fiber diameters, as asked for.
    cells : int
    spacing : float [-]
        (Air volume / cells)^(1/3) in mean fiber diameters.
    pressure_drop : float [Pa]
    pressure_drop_no_slip, pressure_drop_slip : float [Pa] or None
        With either wall.
    seconds : float [s]
        Wall time of mesher and solver.
    """

    edge: float
    cells: int
    spacing: float
    pressure_drop: float
    pressure_drop_no_slip: float | None
    pressure_drop_slip: float | None
    seconds: float


@dataclass(frozen=True, slots=True)
class Contributions:
    """What moves a pressure drop, each relative to its value.

    Parameters
    ----------
    mesh : float [-]
        The case's own mesh against the extrapolated value.
    slip : float [-] or None
        The drop without slip against that with it.
    box : float [-] or None
        A plan of a larger side against the case's, on the same mesh; another draw of fibers is in it too.
    seed : float [-] or None
        Standard deviation over seeds, on the case's mesh.
    """

    mesh: float
    slip: float | None
    box: float | None
    seed: float | None


@dataclass(frozen=True, slots=True)
class ConvergedDrop:
    """A pressure drop with its error.

    Parameters
    ----------
    case : str
    engine : str
        Solver.
    fiber_wall : str
    pressure_drop : Interval [Pa]
        Of this mat in this box: what meshes leave open.
    order : float [-] or None
        Observed; None where the answers swing, or where chance between meshes is larger than their error: then the
        finest mesh gives the value, and the meshes' spread its interval.
    extrapolated : float [Pa]
        Richardson's limit for vanishing cells.
    rungs : tuple of MeshRung
        Coarse to fine.
    contributions : Contributions
    seeds : tuple of float [Pa]
        Drop of each seed on the case's mesh, the case's own first; empty if only that was asked for.
    notes : tuple of str
        What could not be solved beside the case itself, and why.
    """

    case: str
    engine: str
    fiber_wall: str
    pressure_drop: Interval
    order: float | None
    extrapolated: float
    rungs: tuple[MeshRung, ...]
    contributions: Contributions
    seeds: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()


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
