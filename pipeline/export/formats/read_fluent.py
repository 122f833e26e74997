"""Reads Fluent's mesh in text: the sections of nodes, cells, faces, face trees and zone names."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pipeline.export.formats.file_mesh import widened
from pipeline.export.formats.reading import damage_told
from pipeline.nouns.arrays import Floats, Ints, require
from pipeline.nouns.mesh import FaceMesh, Patch

_HEAD = re.compile(rb"\(\s*([^\s()\"]*)")
_PARENTHESIS = re.compile(rb'[()"]')
_ZONE = re.compile(rb"\s*(\d+)\s+\S+\s+(\S+)")
_DIMENSIONS, _NODES, _FACES, _TREE, _ZONES = 2, 10, 13, 59, (39, 45)
_BINARY_FROM = 2000
_SHAPES_PER_ROW = {0, 5}
"""Face types whose rows say their own number of corners: mixed and polygonal."""
_INTERIOR = 2


@dataclass(frozen=True, slots=True)
class _FaceZone:
    number: int
    first: int
    condition: int
    corners: Ints
    cells: Ints


@dataclass(slots=True)
class _Found:
    nodes: list[tuple[int, Floats]] = field(default_factory=list)
    zones: list[_FaceZone] = field(default_factory=list)
    parents: list[Ints] = field(default_factory=list)
    names: dict[int, str] = field(default_factory=dict)


def read_fluent(path: Path) -> FaceMesh:
    """Read a mesh file of Fluent, of any polyhedra.

    A face between two cells is an inner face, whatever its zone is to a solver (a fan, a porous jump, an interface); of
    faces that a tree divides the children count.

    Raises
    ------
    StageError
        If the file is binary, damaged, or flat.
    """
    with damage_told(path):
        return _assemble(_found(path.read_bytes()))


def _found(content: bytes) -> _Found:
    found = _Found()
    for kind, parts in _sections(content):
        require(kind < _BINARY_FROM, "it is binary; write it as text from the program that made it")
        if kind == _DIMENSIONS:
            require(parts[0].split()[:1] != [b"2"], "it is flat: it has two dimensions, not 3")
        elif kind in _ZONES and len(parts) > 1 and (match := _ZONE.match(parts[1])):
            found.names[int(match[1])] = match[2].decode("latin-1")
        elif len(parts) > 2 and kind == _NODES:
            header = _hexadecimal(parts[1])
            found.nodes.append((header[1] - 1, _nodes(header, parts[2])))
        elif len(parts) > 2 and kind == _FACES:
            found.zones.append(_face_zone(_hexadecimal(parts[1]), parts[2]))
        elif len(parts) > 2 and kind == _TREE:
            header = _hexadecimal(parts[1])
            require(len(header) > 1, "its tree of faces is damaged")
            found.parents.append(np.arange(header[0] - 1, header[1]))
    require(bool(found.nodes and found.zones), "it has no nodes or no faces")
    return found


def _sections(content: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Give each section's number, and its text: what stands outside of inner parentheses, then what in each.

    Comments and sections that are not read are passed by with all that they hold: ANSYS Meshing explains the format in
    a comment, with sections as examples.
    """
    place = 0
    while (match := _HEAD.search(content, place)) is not None:
        # a case file has lists between the sections that start with a word
        kind = int(match[1]) if match[1].isdigit() and len(match[1]) < 6 else -1
        if kind >= _BINARY_FROM:
            yield kind, []
        depth, start, parts, at = 1, match.end(), [b""], match.end()
        while depth:
            sign = _PARENTHESIS.search(content, at)
            require(sign is not None, "its last section does not end")
            assert sign is not None
            at = sign.end()
            if sign[0] == b'"':
                at = content.find(b'"', at) + 1
                require(at > 0, "a text in it does not end")
            elif sign[0] == b"(":
                depth += 1
                if depth == 2:
                    parts[0] += content[start : sign.start()]
                    start = at
            else:
                depth -= 1
                if depth == 1:
                    parts.append(content[start : sign.start()])
                    start = at
        place = at
        if kind in (_DIMENSIONS, _NODES, _FACES, _TREE, *_ZONES):
            parts[0] += content[start : at - 1]
            yield kind, parts


def _hexadecimal(words: bytes) -> list[int]:
    return [int(number, 16) for number in words.split()]


def _nodes(header: list[int], body: bytes) -> Floats:
    count = header[2] - header[1] + 1
    require(len(header) <= 4 or header[4] == 3, f"its nodes have {header[-1]} coordinates, not 3")
    values = np.array(body.split(), np.float64)
    require(len(values) == 3 * count, f"it says {count} nodes but has {len(values) / 3:g}")
    return values.reshape(-1, 3)


def _face_zone(header: list[int], body: bytes) -> _FaceZone:
    """Corners of each face counterclockwise seen from inside its first cell, filled up with -1; and its two cells."""
    require(len(header) > 3, "a zone of faces has no kind")
    number, first, last, condition = header[:4]
    count, shape = last - first + 1, header[4] if len(header) > 4 else 0
    numbers = np.array(_hexadecimal(body), np.int64)
    if shape not in _SHAPES_PER_ROW:
        has = len(numbers) / (shape + 2)
        require(has == count, f"zone {number} says {count} faces but has {has:g}")
        table = numbers.reshape(count, shape + 2) - 1
        return _FaceZone(number, first - 1, condition, table[:, :shape], table[:, shape:])
    require(0 <= count <= len(numbers), f"zone {number} says {count} faces but has fewer numbers")
    starts = np.empty(count, np.int64)
    at = 0
    for face in range(count):
        require(at < len(numbers) and numbers[at] >= 2, f"face {face} of zone {number} is missing or no polygon")
        starts[face] = at
        at += int(numbers[at]) + 3
    require(at == len(numbers), f"zone {number} does not end where its {count} faces do")
    sizes = numbers[starts]
    column = np.arange(int(sizes.max(initial=0)))
    places = np.minimum(starts[:, None] + 1 + column, len(numbers) - 1)
    corners = np.where(column < sizes[:, None], numbers[places] - 1, -1)
    cells = numbers[(starts + 1 + sizes)[:, None] + np.arange(2)] - 1
    return _FaceZone(number, first - 1, condition, corners, cells)


def _points(nodes: list[tuple[int, Floats]]) -> Floats:
    """Put the zones' nodes where their numbers say, whatever the order of the zones."""
    count = sum(len(values) for _, values in nodes)
    points = np.full((count, 3), np.nan)
    for first, values in nodes:
        require(0 <= first <= count - len(values), "its zones of nodes do not number them from 1 without gaps")
        points[first : first + len(values)] = values
    # where zones overlap others are not reached
    require(not np.isnan(points).any(), "its zones of nodes do not number them from 1 without gaps")
    return points


def _assemble(found: _Found) -> FaceMesh:
    zones = found.zones
    polygons = widened([zone.corners for zone in zones])
    cells = np.concatenate([zone.cells for zone in zones])
    number = np.concatenate([zone.first + np.arange(len(zone.cells)) for zone in zones])
    zone_of = np.repeat(np.arange(len(zones)), [len(zone.cells) for zone in zones])
    if found.parents:
        kept = ~np.isin(number, np.concatenate(found.parents))
        polygons, cells, zone_of = polygons[kept], cells[kept], zone_of[kept]
    inside = (cells >= 0).all(axis=1)
    interior = np.array([zone.condition == _INTERIOR for zone in zones])
    odd = int((interior[zone_of] & ~inside).sum())
    require(not odd, f"{odd} faces contradict their zone's being interior: they have a cell on one side only")
    require(bool((cells.max(axis=1, initial=-1) >= 0).all()), "a face has no cell")
    if found.parents:
        # cells that were divided have no face left
        cells = np.where(cells >= 0, np.searchsorted(np.unique(cells[cells >= 0]), cells), -1)
    patches = [k for k in range(len(zones)) if bool(((zone_of == k) & ~inside).any())]
    where = np.where(inside, -1, np.searchsorted(patches, zone_of) if patches else -1)
    # a face is written counterclockwise as its first cell sees it; we want it as seen from outside the owner
    first, second = cells.T
    owner = np.where(inside, np.minimum(first, second), np.maximum(first, second))
    other = np.where(inside, np.maximum(first, second), -1)
    sizes = (polygons >= 0).sum(axis=1)
    column = np.arange(polygons.shape[1])
    backward = np.where(column < sizes[:, None], sizes[:, None] - 1 - column, column)
    polygons = np.take_along_axis(polygons, np.where((first == owner)[:, None], backward, column), axis=1)
    order = np.lexsort((other, owner, where))
    polygons = polygons[order]
    counts = np.bincount(where[where >= 0], minlength=len(patches))
    internal = int(inside.sum())
    starts = internal + np.cumsum(counts) - counts
    return FaceMesh(
        points=_points(found.nodes),
        corners=polygons[polygons >= 0],
        offsets=np.concatenate([[0], np.cumsum(sizes[order])]),
        owner=owner[order],
        neighbour=other[order][:internal],
        cells=int(cells.max()) + 1,
        patches=tuple(
            Patch(found.names.get(zones[k].number, f"zone-{zones[k].number}"), int(start), int(count))
            for k, start, count in zip(patches, starts, counts, strict=True)
        ),
    )
