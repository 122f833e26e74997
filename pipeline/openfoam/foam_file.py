"""OpenFOAM's file format: the header of each file, and its lists in text and in binary."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import Literal

from pipeline.nouns.arrays import Floats, Ints

Encoding = Literal["binary", "ascii"]

ARCHITECTURE = "LSB;label=32;scalar=64"
LARGEST_LABEL = 2**31 - 1
_ROWS = 20_000


def format_header(kind: str, name: str, location: str, encoding: Encoding = "ascii", note: str = "") -> str:
    """Header that every OpenFOAM file starts with.

    Examples
    --------
    >>> print(format_header("dictionary", "fvSchemes", "system"))
    FoamFile
    {
        version     2.0;
        format      ascii;
        class       dictionary;
        location    "system";
        object      fvSchemes;
    }
    <BLANKLINE>
    """
    rows = [("version", "2.0"), ("format", encoding)]
    if encoding == "binary":
        rows.append(("arch", f'"{ARCHITECTURE}"'))
    rows.append(("class", kind))
    if note:
        rows.append(("note", f'"{note}"'))
    rows += [("location", f'"{location}"'), ("object", name)]
    return "FoamFile\n{\n" + "".join(f"    {key:<12}{value};\n" for key, value in rows) + "}\n"


def format_dictionary(name: str, location: str, body: str) -> str:
    """Give a whole dictionary: its header, and its entries as they stand."""
    return format_header("dictionary", name, location) + "\n" + body.strip("\n") + "\n"


def format_labels(labels: Ints, encoding: Encoding) -> bytes:
    r"""Give a list of labels.

    Examples
    --------
    >>> import numpy as np
    >>> format_labels(np.array([3, 1]), "ascii")
    b'2\n(\n3\n1\n)\n'
    """
    if encoding == "binary":
        return _binary_list(len(labels), labels.astype("<i4").tobytes())
    return _text_list(len(labels), lambda rows: map(str, labels[rows].tolist()))


def format_vectors(vectors: Floats, encoding: Encoding) -> bytes:
    r"""Give a list of vectors; text has every digit that a double holds, since fewer would move points.

    Examples
    --------
    >>> import numpy as np
    >>> format_vectors(np.array([[0.5, 0, 0.1]]), "ascii")
    b'1\n(\n(0.5 0.0 0.1)\n)\n'
    """
    if encoding == "binary":
        return _binary_list(len(vectors), vectors.astype("<f8").tobytes())
    return _text_list(len(vectors), lambda rows: (f"({x!r} {y!r} {z!r})" for x, y, z in vectors[rows].tolist()))


def format_scalars(scalars: Floats, encoding: Encoding) -> bytes:
    """Give a list of scalars."""
    if encoding == "binary":
        return _binary_list(len(scalars), scalars.astype("<f8").tobytes())
    return _text_list(len(scalars), lambda rows: map(repr, scalars[rows].tolist()))


def format_faces(corners: Ints, offsets: Ints, encoding: Encoding) -> bytes:
    """Give a list of polygons: `faceList` in text, `faceCompactList` (offsets, then corners) in binary."""
    if encoding == "binary":
        return format_labels(offsets, encoding) + format_labels(corners, encoding)

    def polygons(rows: slice) -> Iterable[str]:
        starts = offsets[rows.start : rows.stop + 1]
        text = list(map(str, corners[starts[0] : starts[-1]].tolist()))
        return (f"{b - a}({' '.join(text[a:b])})" for a, b in pairwise((starts - starts[0]).tolist()))

    return _text_list(len(offsets) - 1, polygons)


def _binary_list(count: int, content: bytes) -> bytes:
    # an empty list has no parentheses in binary
    return b"%d\n(" % count + content + b")\n" if count else b"0\n"


def _text_list(count: int, lines: Callable[[slice], Iterable[str]]) -> bytes:
    # a piece at a time: as text, numbers take ten times the memory that they do in an array
    pieces = [f"{count}\n(\n".encode()]
    for start in range(0, count, _ROWS):
        pieces.append(("\n".join(lines(slice(start, min(start + _ROWS, count)))) + "\n").encode())
    return b"".join([*pieces, b")\n"])
