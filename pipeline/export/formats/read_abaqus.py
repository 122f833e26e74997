"""Reads Abaqus' input file: nodes and elements of all parts and instances, sets and surfaces as patches."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pipeline.export.formats.file_mesh import Cells, FileMesh, NamedFaces, face_mesh, grouped, rows_by_number
from pipeline.export.formats.reading import damage_told
from pipeline.nouns.arrays import Floats, require
from pipeline.nouns.mesh import FaceMesh

_VOLUME = re.compile(r"(?:AC|DCC?|E?C|FC|Q)3D(\d+)[A-Z]*")
_SHELL = re.compile(r"(?:STRI|DS|S|M3D|SFM3D|R3D|F3D|CPS|CPE|CAX|DC2D)([34])[A-Z]*")
_KINDS = {4: "tetra", 5: "pyramid", 6: "wedge", 8: "hexahedron"}
_SIDES = {
    "tetra": ((1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1)),
    "pyramid": ((1, 2, 3, 4), (1, 5, 2), (2, 5, 3), (3, 5, 4), (4, 5, 1)),
    "wedge": ((1, 2, 3), (4, 6, 5), (1, 4, 5, 2), (2, 5, 6, 3), (3, 6, 4, 1)),
    "hexahedron": ((1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)),
}
"""Nodes of each kind's sides S1, S2, ..., as Abaqus numbers them."""
_MAKERS = {"NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "TIE_ELEMENTS"}
"""Keywords that make nodes or elements by a rule."""


_MOST_NAMED = 1_000_000


@dataclass(slots=True)
class _Part:
    """Nodes, elements and sets under one numbering."""

    nodes: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, list[int]]] = field(default_factory=dict)
    sets: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)


@dataclass(slots=True)
class _Model:
    """What the file defines, and the names as they were first written: Abaqus' own do not mind case."""

    parts: dict[str, _Part] = field(default_factory=lambda: {"": _Part()})
    instances: dict[str, tuple[str, list[list[float]]]] = field(default_factory=dict)
    spelled: dict[str, str] = field(default_factory=dict)
    named: int = 0


def read_abaqus(path: Path) -> FaceMesh:
    """Read solid elements; shells in sets, and surfaces by sides of elements, become patches.

    Raises
    ------
    StageError
        If the file is damaged, has elements with nodes on their edges, makes nodes by a rule, or would open another
        file.
    """
    with damage_told(path):
        return face_mesh(_content(_parsed(path.read_text(encoding="latin-1"))))


def _blocks(text: str) -> Iterator[tuple[str, dict[str, str], list[list[str]]]]:
    """Give each keyword with its options and the data lines behind it, as words between commas."""
    keyword, options, data = "", dict[str, str](), list[list[str]]()
    pending = ""
    for raw in text.splitlines():
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if pending or line.startswith("*"):
            pending += line
            # a keyword's line goes on behind its last comma
            if line.endswith(","):
                continue
            if keyword:
                yield keyword, options, data
            name, *rest = (word.strip() for word in pending[1:].split(","))
            keyword, data, pending = re.sub(r"\s+", " ", name.upper()), [], ""
            pairs = (word.partition("=") for word in rest if word)
            options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
        else:
            data.append([word.strip() for word in line.split(",")])
    if keyword:
        yield keyword, options, data


def _parsed(text: str) -> _Model:
    model = _Model()
    part = instance = ""
    later = []
    for keyword, options, data in _blocks(text):
        require(
            keyword != "INCLUDE" and "INPUT" not in options,
            f"*{keyword} names another file, which a mesh file may not; put its lines in its place",
        )
        require(keyword not in _MAKERS, f"*{keyword} makes nodes or elements by a rule; write them out")
        require(
            keyword != "SYSTEM" and options.get("SYSTEM", "R").upper() in ("R", ""),
            f"*{keyword} gives nodes in another coordinate system; write them in the global one",
        )
        if keyword == "PART":
            part = options.get("NAME", "").upper()
            model.parts.setdefault(part, _Part())
        elif keyword in ("END PART", "END ASSEMBLY"):
            part = ""
        elif keyword == "INSTANCE":
            instance = options.get("NAME", "").upper()
            model.instances[instance] = (
                options.get("PART", "").upper(),
                [[float(w) for w in row if w] for row in data],
            )
            model.parts.setdefault(f"/{instance}", _Part())
        elif keyword == "END INSTANCE":
            instance = ""
        else:
            of = options.get("INSTANCE", "").upper()
            own = model.parts.setdefault(f"/{of or instance}" if of or instance else part, _Part())
            if keyword in ("ELSET", "SURFACE"):
                # a set may stand before the elements that it names
                later.append((own, keyword, options, data))
            else:
                _define(model, own, keyword, options, data)
    for own, keyword, options, data in later:
        _group(model, own, keyword, options, data)
    return model


def _define(model: _Model, part: _Part, keyword: str, options: dict[str, str], data: list[list[str]]) -> None:
    if keyword == "NODE":
        for row in data:
            part.nodes[int(row[0])] = [float(word or 0) for word in [*row[1:], "", "", ""][:3]]
    elif keyword == "ELEMENT":
        found = list(_elements(options.get("TYPE", "").upper(), data))
        part.elements |= {number: (kind, corners) for number, kind, corners in found}
        if "ELSET" in options:
            _extend(model, part, options["ELSET"], [number for number, _, _ in found])


def _group(model: _Model, part: _Part, keyword: str, options: dict[str, str], data: list[list[str]]) -> None:
    if keyword == "ELSET":
        members = _generated(part, data) if "GENERATE" in options else _members(part, data)
        _extend(model, part, options.get("ELSET", ""), list(members))
    elif options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
        name = options.get("NAME", "")
        model.spelled.setdefault(name.upper(), name)
        rows = [(row[0], row[1].upper() if len(row) > 1 else "") for row in data]
        part.surfaces[name.upper()] = list(dict.fromkeys([*part.surfaces.get(name.upper(), []), *rows]))


def _extend(model: _Model, part: _Part, name: str, members: list[int]) -> None:
    model.spelled.setdefault(name.upper(), name)
    part.sets[name.upper()] = list(dict.fromkeys([*part.sets.get(name.upper(), []), *members]))
    model.named += len(members)
    # a set of sets of sets could name more than a machine can hold
    most = _MOST_NAMED + 100 * sum(len(each.elements) for each in model.parts.values())
    require(model.named <= most, f"its sets name {model.named} elements, far more than it has")


def _elements(type_: str, data: list[list[str]]) -> Iterator[tuple[int, str, list[int]]]:
    volume, shell = _VOLUME.fullmatch(type_), _SHELL.fullmatch(type_)
    if volume is None and shell is None:
        return
    size = int((volume or shell or [0, 0])[1])
    require(
        volume is None or size in _KINDS, f"elements {type_} have {size} nodes: write the mesh with linear elements"
    )
    words: list[str] = []
    for row in data:
        words += [word for word in row if word]
        # a long element goes on in the next line
        if len(words) > size:
            yield int(words[0]), _KINDS[size] if volume else "shell", [int(word) for word in words[1 : 1 + size]]
            words = []
    require(not words, f"the last element {type_} ends before its {size} nodes")


def _generated(part: _Part, data: list[list[str]]) -> Iterator[int]:
    """Give the elements of ranges: first, last and step. One that is not there is not named."""
    numbers = np.array(sorted(part.elements), np.int64)
    for row in data:
        words = [int(word) for word in row if word]
        require(len(words) in (2, 3), "a set is generated by two or three numbers in a line")
        first, last, step = [*words, 1][:3]
        require(step > 0, "a set is generated by steps that are not above 0")
        within = numbers[np.searchsorted(numbers, first) : np.searchsorted(numbers, last, side="right")]
        yield from within[(within - first) % step == 0].tolist()


def _members(part: _Part, data: list[list[str]]) -> Iterator[int]:
    for word in dict.fromkeys(word for row in data for word in row if word):
        if word.isdigit():
            yield int(word)
        else:
            yield from part.sets.get(word.strip('"').upper(), [])


def _content(model: _Model) -> FileMesh:
    points: list[Floats] = []
    cells: list[Cells] = []
    surfaces: list[NamedFaces] = []
    placed: list[tuple[str | None, str, list[list[float]]]]
    placed = [(name, *where) for name, where in model.instances.items()]
    for name, of, moves in placed or [(None, part, []) for part in model.parts]:
        part = model.parts.get(of, _Part())
        own = model.parts.get(f"/{name}", _Part()) if name is not None else _Part()
        whole = _Part(
            part.nodes | own.nodes, part.elements | own.elements, _joined(part.sets, own.sets),
            _joined(part.surfaces, own.surfaces),
        )  # fmt: skip
        first = sum(map(len, points))
        numbers = np.array(list(whole.nodes), np.int64)
        points.append(_moved(np.array(list(whole.nodes.values()), np.float64).reshape(-1, 3), moves))
        cells += [Cells(block.kind, first + rows_by_number(numbers, block.corners, "node")) for block in _cells(whole)]
        for group in _faces(model, whole, model.parts[""] if name is not None else _Part()):
            rows = np.where(group.polygons >= 0, group.polygons, group.polygons[:, :1])
            found = first + rows_by_number(numbers, rows, "node")
            surfaces.append(NamedFaces(np.where(group.polygons >= 0, found, -1), group.name))
    if placed and model.parts[""].elements:
        raise ValueError("it has elements in a part's instance and others outside of any part")
    every = np.concatenate(points) if points else np.empty((0, 3))
    return FileMesh(every, cells, surfaces)


def _joined(first: dict[str, list], second: dict[str, list]) -> dict[str, list]:  # type: ignore[type-arg]
    return {name: [*first.get(name, []), *second.get(name, [])] for name in {**first, **second}}


def _cells(part: _Part) -> list[Cells]:
    volume: dict[str, list[list[int]]] = {}
    for kind, corners in part.elements.values():
        if kind != "shell":
            volume.setdefault(kind, []).append(corners)
    return [Cells(kind, np.array(rows, np.int64)) for kind, rows in volume.items()]


def _faces(model: _Model, part: _Part, outer: _Part) -> list[NamedFaces]:
    """Shells by the sets that hold them, and the sides of elements that surfaces name."""
    faces: list[tuple[str | int | None, list[int]]] = []
    for name, members in part.sets.items():
        shells = (part.elements[number] for number in members if number in part.elements)
        faces += [(model.spelled[name], corners) for kind, corners in shells if kind == "shell"]
    for name, rows in {**part.surfaces, **outer.surfaces}.items():
        for member, side in rows:
            faces += [(model.spelled[name], corners) for corners in _side(part, member, side)]
    return grouped(iter(faces))


def _side(part: _Part, member: str, side: str) -> Iterator[list[int]]:
    numbers = [int(member)] if member.isdigit() else part.sets.get(member.strip('"').upper(), [])
    for number in numbers:
        kind, corners = part.elements.get(number, ("", []))
        if kind == "shell":
            yield corners
        elif kind and side:
            place = int(side.removeprefix("S")) - 1 if side.removeprefix("S").isdigit() else -1
            require(0 <= place < len(_SIDES[kind]), f"element {number} has no side {side}")
            yield [corners[corner - 1] for corner in _SIDES[kind][place]]


def _moved(points: Floats, moves: list[list[float]]) -> Floats:
    """Move an instance's points by its first line, and turn them by its second: two points of an axis, and degrees."""
    if moves:
        points = points + np.array([*moves[0], 0.0, 0.0, 0.0][:3])
    if len(moves) > 1:
        require(len(moves[1]) == 7, "an instance is turned by seven numbers")
        start, end = np.array(moves[1][:3]), np.array(moves[1][3:6])
        require(bool((start != end).any()), "an instance is turned about an axis without length")
        axis, angle = (end - start) / np.linalg.norm(end - start), np.radians(moves[1][6])
        arm = points - start
        along = np.outer(arm @ axis, axis)
        points = start + along + (arm - along) * np.cos(angle) + np.cross(axis, arm) * np.sin(angle)
    return points
