"""NASTRAN bulk data: large fields for points, so that a coordinate keeps 9 to 12 digits."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from pathlib import Path

from pipeline.export.formats.format import Format, Order
from pipeline.export.formats.read_nastran import read_nastran
from pipeline.export.formats.text import groups, rows, write_numbers, write_text
from pipeline.nouns.mesh import FaceMesh

_WIDTH = 16  # characters of a large field
_CARDS = {4: "CTETRA", 3: "CTRIA3"}


def write_nastran(mesh: FaceMesh, folder: Path, order: Order) -> None:
    """Write `mesh.bdf` in meters, each patch with a property number, and `patches.txt` with their names."""
    order.progress("export: nastran")
    write_text(folder / "mesh.bdf", format_nastran(mesh))
    write_numbers(mesh, folder)


def format_nastran(mesh: FaceMesh) -> Iterator[str]:
    """Give the file's text, piece by piece."""
    yield "$ written by fibertwin, in meters\nBEGIN BULK\n"
    # HyperMesh's way to name a property, which others read too
    yield from (f'$HMNAME COMP {number:>19}"{name}"\n' for number, name, _ in groups(mesh))
    yield from rows(
        mesh.points,
        lambda k, p: f"GRID*   {k + 1:>16}{'':16}{large_field(p[0])}{large_field(p[1])}\n*       {large_field(p[2])}\n",
    )
    first = 1
    for number, _, cells in groups(mesh):
        card = _CARDS[cells.shape[1]]
        yield from rows(
            cells + 1,
            lambda k, c, card=card, number=number, first=first: (  # type: ignore[misc]
                f"{card:<8}{first + k:>8}{number:>8}" + "".join(f"{corner:>8}" for corner in c) + "\n"
            ),
        )
        first += len(cells)
    yield "ENDDATA\n"


def large_field(value: float) -> str:
    """Give a number in 16 characters, with as many digits as fit.

    Examples
    --------
    >>> large_field(-1.23456789012345e-05), large_field(0.0), large_field(1 / 3)
    ('-1.23456789012-5', '             0.0', '3.333333333333-1')
    >>> large_field(-4.2e-110)
    '-4.200000000-110'
    """
    if value == 0.0:
        return f"{'0.0':>{_WIDTH}}"
    for digits in range(_WIDTH - 4, 0, -1):
        mantissa, exponent = f"{value:.{digits}e}".split("e")
        text = f"{mantissa}{int(exponent):+d}"
        if len(text) <= _WIDTH:
            break
    return f"{text:>{_WIDTH}}"


FORMAT = Format(
    "nastran",
    (".bdf", ".nas", ".dat", ".fem"),
    cells="tetrahedra",
    patches="by number",
    write=write_nastran,
    read=read_nastran,
)
