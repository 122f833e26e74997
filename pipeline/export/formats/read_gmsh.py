"""Reads gmsh's mesh, versions 2.2, 4.0 and 4.1, in text and in binary."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pipeline.export.formats.file_mesh import Cells, FileMesh, face_mesh, named, rows_by_number
from pipeline.export.formats.gmsh_numbers import Numbers
from pipeline.export.formats.reading import damage_told
from pipeline.nouns.arrays import Floats, Ints, require
from pipeline.nouns.mesh import FaceMesh

_CORNERS = {1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 12: 27, 13: 18, 14: 14, 15: 1,
            16: 8, 17: 20, 18: 15, 19: 13}  # fmt: skip
"""Nodes of each of gmsh's kinds of element; no other has a place in a mesh of air."""
_CELLS = {4: "tetra", 5: "hexahedron", 6: "wedge", 7: "pyramid"}
_FACES = {2, 3}
_CURVED = {11, 12, 13, 14, 17, 18, 19}
_SECTION = re.compile(rb"\$(?P<name>[A-Za-z]+)[ \t]*\r?\n")
_PHYSICAL = re.compile(r'\s*(\d+)\s+(\d+)\s+"([^"]*)"')

_Block = tuple[int, Ints, list[str | int | None]]
"""Kind of element, corners by node number, and the names of the groups that the elements are in."""


def read_gmsh(path: Path) -> FaceMesh:
    """Read a mesh; each physical group of surfaces becomes a patch.

    Raises
    ------
    StageError
        If the file is damaged, partitioned, or has curved elements.
    """
    with damage_told(path):
        return face_mesh(_content(path.read_bytes()))


def _content(content: bytes) -> FileMesh:
    sections = dict(_sections(content))
    require("MeshFormat" in sections, "it has no $MeshFormat")
    head = sections["MeshFormat"].split(maxsplit=3)
    require(len(head) >= 3 and head[1] in (b"0", b"1"), "its $MeshFormat is damaged")
    version, binary = head[0].decode("latin-1"), head[1] == b"1"
    require(
        version[:1] == "2" or version in ("4", "4.0", "4.1"), f"version {version[:10]} of gmsh's format is not read"
    )
    require(
        not binary or (len(head) > 3 and head[3][:4] == (1).to_bytes(4, "little")),
        "it was written on a big-endian machine",
    )
    require("PartitionedEntities" not in sections, "it is partitioned; save it whole from gmsh")
    require("Nodes" in sections and "Elements" in sections, "it has no $Nodes or no $Elements")
    names = _physical_names(sections.get("PhysicalNames", b""))

    def numbers(section: str) -> Numbers:
        return Numbers(sections[section], binary, section)

    if version[:1] == "2":
        known, points = _nodes_2(numbers("Nodes"))
        blocks = list(_elements_2(numbers("Elements"), names))
    else:
        groups = _groups(numbers("Entities"), names, version) if "Entities" in sections else {}
        known, points = _nodes_4(numbers("Nodes"), version)
        blocks = list(_elements_4(numbers("Elements"), groups, version))
    return _mesh(known, points, blocks)


def _sections(content: bytes) -> Iterator[tuple[str, bytes]]:
    place = 0
    while (match := _SECTION.search(content, place)) is not None:
        name = match["name"]
        end = content.find(b"$End" + name, match.end())
        require(end >= 0, f"${name.decode()[:40]} does not end")
        yield name.decode(), content[match.end() : end]
        place = end + len(b"$End" + name)


def _physical_names(section: bytes) -> dict[tuple[int, int], str]:
    lines = section.decode("utf-8", errors="replace").splitlines()[1:]
    return {(int(m[1]), int(m[2])): m[3] for line in lines if (m := _PHYSICAL.match(line))}


def _named(names: dict[tuple[int, int], str], group: int) -> str | int | None:
    # a group's sign is its direction
    return names.get((2, abs(group)), abs(group)) if group else None


def _nodes_2(file: Numbers) -> tuple[Ints, Floats]:
    count = file.count()
    return file.numbered(count, 3)


def _elements_2(file: Numbers, names: dict[tuple[int, int], str]) -> Iterator[_Block]:
    """Elements of the same kind in the same group, in blocks."""
    count = file.count()
    found: dict[tuple[int, int], list[Ints]] = {}
    for kind, rows in file.elements_2(count, _CORNERS):
        # the first tag is the physical group
        for group in np.unique(rows[:, 0]).tolist():
            found.setdefault((kind, group), []).append(rows[rows[:, 0] == group, 1:])
    for (kind, group), parts in found.items():
        yield kind, np.concatenate(parts), [_named(names, group)]


def _groups(file: Numbers, names: dict[tuple[int, int], str], version: str) -> dict[int, list[str | int | None]]:
    """Names of the physical groups of each surface."""
    counts = file.sizes(4)
    for dimension, count in enumerate(counts[:2]):
        for _ in range(count):
            file.entity(dimension, version)
    groups = {}
    for _ in range(counts[2]):
        tag, physical = file.entity(2, version)
        groups[tag] = [_named(names, group) for group in physical if group]
    return groups


def _nodes_4(file: Numbers, version: str) -> tuple[Ints, Floats]:
    numbers, points = [np.empty(0, np.int64)], [np.empty((0, 3))]
    for _ in range(file.blocks(version)):
        found = file.node_block(version)
        numbers.append(found[0])
        points.append(found[1])
    return np.concatenate(numbers), np.concatenate(points)


def _elements_4(file: Numbers, groups: dict[int, list[str | int | None]], version: str) -> Iterator[_Block]:
    for _ in range(file.blocks(version)):
        dimension, entity, kind, corners = file.element_block(version, _CORNERS)
        yield kind, corners, [*(groups.get(entity, []) if dimension == 2 else [])] or [None]


def _mesh(known: Ints, points: Floats, blocks: list[_Block]) -> FileMesh:
    curved = sum(len(corners) for kind, corners, _ in blocks if kind in _CURVED)
    require(not curved, f"{curved} cells have nodes on their edges: write the mesh with linear elements (order 1)")
    cells: dict[str, list[Ints]] = {}
    surfaces = []
    for kind, corners, names in blocks:
        if kind in _CELLS:
            cells.setdefault(_CELLS[kind], []).append(corners)
        elif kind in _FACES:
            rows = rows_by_number(known, corners, "node")
            surfaces += [named(rows, name) for name in names]
    # a cell in two groups stands there twice
    once = {kind: _each_once(np.concatenate(parts)) for kind, parts in cells.items()}
    return FileMesh(points, [Cells(kind, rows_by_number(known, rows, "node")) for kind, rows in once.items()], surfaces)


def _each_once(cells: Ints) -> Ints:
    _, index = np.unique(np.sort(cells, axis=1), axis=0, return_index=True)
    return cells[np.sort(index)]
