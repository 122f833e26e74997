"""What a medium lets through along each of its axes."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from pathlib import Path

from pipeline.nouns.section import Table
from pipeline.reading import read_bytes

RESULT = "permeability.json"
"""File of a run's folder that holds what `fibertwin permeability` found."""
_LARGEST = 1_000_000  # bytes


@dataclass(frozen=True, slots=True)
class AlongAxis:
    """The flow along one axis of a mat.

    Parameters
    ----------
    permeability : float [m2]
        Darcy's: viscosity x face velocity x length / pressure drop.
    pressure_drop : float [Pa]
    length : float [m]
        Of the medium along the axis.
    face_area : float [m2]
        That the flow meets.
    run : str
        Folder of the run it was solved in.
    """

    permeability: float
    pressure_drop: float
    length: float
    face_area: float
    run: str


@dataclass(frozen=True, slots=True)
class Permeability:
    """Darcy's permeability along the axes of a mat.

    Parameters
    ----------
    case : str
    fiber_wall : str
    solidity : float [-]
        Of the mat's surface.
    x, y : AlongAxis
        In the mat's plane.
    z : AlongAxis
        Through the mat.
    tensor : 3 x 3 tuple of float [m2]
        Diagonal: a medium that goes on as its mirror image beyond its sides has no other entries.
    in_plane_over_through : float [-]
        Mean of x and y over z.
    """

    case: str
    fiber_wall: str
    solidity: float
    x: AlongAxis
    y: AlongAxis
    z: AlongAxis
    tensor: tuple[tuple[float, float, float], ...]
    in_plane_over_through: float


def permeability_table(found: Permeability) -> Table:
    """Give the permeabilities in the units people use."""
    rows = []
    for name, what in (("x", "x, in the plane"), ("y", "y, in the plane"), ("z", "z, through the mat")):
        one: AlongAxis = getattr(found, name)
        rows.append((what, f"{1e12 * one.permeability:.4g}", f"{one.pressure_drop:.4g}", f"{1e6 * one.length:.4g}"))
    rows.append(("in the plane over through", f"{found.in_plane_over_through:.3g}", "", ""))
    return Table("permeability", ("along", "um2", "Pa", "length, um"), tuple(rows))


def read_permeability(folder: Path) -> Permeability | None:
    """Read what `fibertwin permeability` left in a run's folder; None where it left nothing that can be read."""
    from pydantic import TypeAdapter, ValidationError

    try:
        return TypeAdapter(Permeability).validate_json(read_bytes(folder / RESULT, _LARGEST, links=False))
    except (OSError, ValidationError):
        return None
