"""OpenFOAM's file format: the header of each file, and its lists in text and in binary."""

from collections.abc import Iterable
from itertools import pairwise

from pipeline.data import Floats, Ints
from pipeline.export.settings import Encoding

ARCHITECTURE = "LSB;label=32;scalar=64"
LARGEST_LABEL = 2**31 - 1


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
    return _text_list(map(str, labels.tolist()), len(labels))


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
    return _text_list((f"({x!r} {y!r} {z!r})" for x, y, z in vectors.tolist()), len(vectors))


def format_scalars(scalars: Floats, encoding: Encoding) -> bytes:
    """Give a list of scalars."""
    if encoding == "binary":
        return _binary_list(len(scalars), scalars.astype("<f8").tobytes())
    return _text_list(map(repr, scalars.tolist()), len(scalars))


def format_faces(corners: Ints, offsets: Ints, encoding: Encoding) -> bytes:
    """Give a list of polygons: `faceList` in text, `faceCompactList` (offsets, then corners) in binary."""
    if encoding == "binary":
        return format_labels(offsets, encoding) + format_labels(corners, encoding)
    text, starts = list(map(str, corners.tolist())), offsets.tolist()
    polygons = (text[a:b] for a, b in pairwise(starts))
    return _text_list((f"{len(polygon)}({' '.join(polygon)})" for polygon in polygons), len(starts) - 1)


def _binary_list(count: int, content: bytes) -> bytes:
    # an empty list has no parentheses in binary
    return b"%d\n(" % count + content + b")\n" if count else b"0\n"


def _text_list(rows: Iterable[str], count: int) -> bytes:
    lines = "\n".join(rows)
    return f"{count}\n(\n{lines}\n)\n".encode() if count else b"0\n(\n)\n"
