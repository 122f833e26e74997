"""Reads Fluent's mesh in text: the sections of nodes, cells, faces and zone names."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from pathlib import Path

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh, Patch

_SECTION = re.compile(rb"\(\s*(?P<kind>\d+)\s*\(([^()]*)\)\s*(?P<body>\(?)")
_NAME = re.compile(rb"\(\s*(?:39|45)\s*\(\s*(\d+)\s+\S+\s+([^\s()]+)[^()]*\)")
_NODES, _FACES = 10, 13
_BINARY_FROM = 2000
_SHAPES_PER_ROW = {0, 5}
"""Face types whose rows say their own number of corners: mixed and polygonal."""
_INTERIOR = 2


def read_fluent(path: Path) -> FaceMesh:
    """Read a mesh file of Fluent, of any polyhedra.

    Raises
    ------
    StageError
        If the file is binary, damaged, or has hanging nodes kept as a tree.
    """
    try:
        return _read(path.read_bytes())
    except (OSError, ValueError, IndexError, OverflowError) as problem:
        raise StageError(f"cannot read the Fluent mesh {path}: {problem}") from problem


def _read(content: bytes) -> FaceMesh:
    points: list[Floats] = []
    zones: list[tuple[int, int, Ints, Ints]] = []
    place = 0
    while (match := _SECTION.search(content, place)) is not None:
        place = match.end()
        kind = int(match["kind"])
        if kind >= _BINARY_FROM:
            raise ValueError("it is binary; write it as text from the program that made it")
        if kind not in (_NODES, _FACES) or not match["body"]:
            continue
        end = content.find(b")", place)
        if end < 0:
            raise ValueError("its last section does not end")
        header = [int(number, 16) for number in match[2].split()]
        body, place = content[place:end], end
        if kind == _NODES:
            points.append(_nodes(header, body))
        else:
            zones.append((header[0], header[3], *_faces(header, body)))
    if not points or not zones:
        raise ValueError("it has no nodes or no faces")
    names = {int(zone): name.decode("latin-1") for zone, name in _NAME.findall(content)}
    return _assemble(np.concatenate(points), zones, names)


def _nodes(header: list[int], body: bytes) -> Floats:
    count = header[2] - header[1] + 1
    if len(header) > 4 and header[4] != 3:
        raise ValueError(f"its nodes have {header[4]} coordinates, not 3")
    values = np.array(body.split(), np.float64)
    if len(values) != 3 * count:
        raise ValueError(f"it says {count} nodes but has {len(values) / 3:g}")
    return values.reshape(-1, 3)


def _faces(header: list[int], body: bytes) -> tuple[Ints, Ints]:
    """Corners of each face counterclockwise seen from inside its first cell, filled up with -1; and its two cells."""
    count, shape = header[2] - header[1] + 1, header[4] if len(header) > 4 else 0
    numbers = np.array([int(number, 16) for number in body.split()], np.int64)
    if shape not in _SHAPES_PER_ROW:
        if len(numbers) != count * (shape + 2):
            raise ValueError(f"zone {header[0]} says {count} faces but has {len(numbers) / (shape + 2):g}")
        table = numbers.reshape(count, shape + 2) - 1
        return table[:, :shape], table[:, shape:]
    starts = np.empty(count, np.int64)
    at = 0
    for face in range(count):
        if at >= len(numbers) or numbers[at] < 3:
            raise ValueError(f"face {face} of zone {header[0]} is missing or no polygon")
        starts[face] = at
        at += int(numbers[at]) + 3
    if at != len(numbers):
        raise ValueError(f"zone {header[0]} does not end where its {count} faces do")
    sizes = numbers[starts]
    column = np.arange(int(sizes.max(initial=0)))
    places = np.minimum(starts[:, None] + 1 + column, len(numbers) - 1)
    corners = np.where(column < sizes[:, None], numbers[places] - 1, -1)
    return corners, numbers[(starts + 1 + sizes)[:, None] + np.arange(2)] - 1


def _assemble(points: Floats, zones: list[tuple[int, int, Ints, Ints]], names: dict[int, str]) -> FaceMesh:
    width = max(corners.shape[1] for _, _, corners, _ in zones)
    polygons = np.concatenate(
        [np.pad(corners, ((0, 0), (0, width - corners.shape[1])), constant_values=-1) for _, _, corners, _ in zones]
    )
    cells = np.concatenate([pair for _, _, _, pair in zones])
    patches = [zone for zone, condition, _, _ in zones if condition != _INTERIOR]
    of_zone = [-1 if condition == _INTERIOR else patches.index(zone) for zone, condition, _, _ in zones]
    where = np.repeat(of_zone, [len(corners) for _, _, corners, _ in zones])
    inside = (cells >= 0).all(axis=1)
    if (inside != (where < 0)).any():
        raise ValueError(f"{int((inside != (where < 0)).sum())} faces contradict their zone's being interior")
    # a face is written counterclockwise as its first cell sees it; we want it as seen from outside the owner
    first, second = cells.T
    owner = np.where(inside, np.minimum(first, second), np.maximum(first, second))
    other = np.where(inside, np.maximum(first, second), -1)
    sizes = (polygons >= 0).sum(axis=1)
    column = np.arange(width)
    backward = np.where(column < sizes[:, None], sizes[:, None] - 1 - column, column)
    polygons = np.take_along_axis(polygons, np.where((first == owner)[:, None], backward, column), axis=1)
    order = np.lexsort((other, owner, where))
    polygons = polygons[order]
    counts = np.bincount(where[where >= 0], minlength=len(patches))
    internal = int(inside.sum())
    starts = internal + np.cumsum(counts) - counts
    return FaceMesh(
        points=points,
        corners=polygons[polygons >= 0],
        offsets=np.concatenate([[0], np.cumsum(sizes[order])]),
        owner=owner[order],
        neighbour=other[order][:internal],
        cells=int(cells.max()) + 1,
        patches=tuple(
            Patch(names.get(zone, f"zone-{zone}"), int(start), int(count))
            for zone, start, count in zip(patches, starts, counts, strict=True)
        ),
    )
