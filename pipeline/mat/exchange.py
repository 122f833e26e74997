"""Fibers as text: CSV in and out, and the list of cylinders that SpaceClaim builds from (docs/mat.md)."""

# SPDX-License-Identifier: GPL-3.0-or-later

import csv
import errno
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.geometry.triangles import Floats
from pipeline.nouns.fibers import Mat
from pipeline.reading import read_bytes
from pipeline.units import parse

_COLUMNS = ("fiber", "x", "y", "z", "radius")
_HEADER = re.compile(r"\s*(?P<name>\w+)\s*(?:\[\s*(?P<unit>[^\]]+?)\s*\])?\s*")
_NOTE = re.compile(r"#\s*(?P<key>plan|thickness|periodic)\s*:\s*(?P<value>.*?)\s*")
_PER_METER = 1e6
LARGEST_FILE = 200_000_000
"""No file of fibers is larger than this many bytes: as Python's own numbers its points take ten times as much."""


@dataclass
class _Notes:
    """What the comment lines of a file state about its slab [m]; None where they are silent."""

    plan: tuple[float, float] | None = None
    thickness: float | None = None
    periodic: bool | None = None


@dataclass
class _Fibers:
    """Points as read, with the line each stood on."""

    nodes: list[tuple[float, float, float]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    radius: list[float] = field(default_factory=list)
    first: list[int] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    seen: set[str] = field(default_factory=set)


def write_fibers(mat: Mat, path: Path) -> None:
    """Write a mat's center lines as CSV, in micrometers, one line per point.

    Parameters
    ----------
    mat : Mat
    path : Path
        `read_fibers` gives the same mat back, to the rounding of the change of unit.
    """
    x, y, z = (size * _PER_METER for size in mat.slab.size)
    lines = [
        f"# {mat.origin}",
        f"# plan: {x!r} um x {y!r} um",
        f"# thickness: {z!r} um",
        f"# periodic: {'yes' if mat.periodic else 'no'}",
        ",".join(["fiber", *(f"{name} [um]" for name in _COLUMNS[1:])]),
    ]
    nodes = (mat.nodes - mat.slab.lower) * _PER_METER
    fiber = np.repeat(np.arange(mat.fibers), np.diff(mat.first))
    radius = (mat.radius * _PER_METER)[fiber]
    for k, (px, py, pz), r in zip(fiber.tolist(), nodes.tolist(), radius.tolist(), strict=True):
        lines.append(f"{k},{px!r},{py!r},{pz!r},{r!r}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_spaceclaim(mat: Mat, path: Path) -> None:
    """Write the paper's list of cylinders: per segment its start, its end, and a point on the surface at the end.

    Parameters
    ----------
    mat : Mat
    path : Path
        Gets nine numbers per line [m], the unit of SpaceClaim's scripts, separated by tabs.
    """
    start = mat.segment_starts()
    begin, end = mat.nodes[start], mat.nodes[start + 1]
    axis = (end - begin) / mat.segment_lengths()[:, None]
    # any direction across the axis: here the one that is level
    level = np.column_stack([-axis[:, 1], axis[:, 0], np.zeros(len(axis))])
    upright = np.hypot(axis[:, 0], axis[:, 1]) < 1e-6
    level[upright] = [1.0, 0.0, 0.0]
    level -= np.einsum("ij,ij->i", level, axis)[:, None] * axis
    level /= np.linalg.norm(level, axis=1)[:, None]
    on_surface = end + mat.radius[mat.segment_fibers()][:, None] * level
    text = io.StringIO()
    np.savetxt(text, np.column_stack([begin, end, on_surface]), fmt="%.12e", delimiter="\t")
    path.write_text(text.getvalue(), encoding="utf-8")


def read_fibers(path: Path, side: float | None = None, periodic: bool | None = None) -> Mat:
    """Read center lines from CSV.

    Parameters
    ----------
    path : Path
        Columns fiber, x, y, z and radius, in any order, with their units in the header, as ``x [um]``.
    side : float, optional [m]
        Edge of the square plan, from (0, 0), where the file states none.
    periodic : bool, optional
        Whether the plan wraps; unless given, what the file says, or no.

    Returns
    -------
    Mat
        Where neither `side` nor the file states a plan, the fibers are moved so that the smallest rectangle around
        the center lines starts at (0, 0); where the file states no thickness, so that the lowest surface lies at
        z = 0.

    Raises
    ------
    CaseError
        If the file is wrong, with the line, the column and the reason.
    """
    try:
        text = read_bytes(path, LARGEST_FILE).decode("utf-8-sig")
    except OSError as problem:
        advice = "; leave out points on straight pieces" if problem.errno == errno.EFBIG else ""
        raise CaseError(f"cannot read the fibers of {path}: {problem.strerror}{advice}") from problem
    except UnicodeDecodeError as problem:
        raise CaseError(f"{path} is not a text file in UTF-8: {problem.reason} at byte {problem.start}") from problem
    except ValueError as problem:
        raise CaseError(f"cannot read the fibers of {str(path)!r}: {problem}") from problem
    notes, fibers = _Notes(), _Fibers()
    rows = _rows(text, notes, path)
    number, header = next(rows, (1, []))
    columns, per_meter = _read_header(header, path, number)
    for number, row in rows:
        if len(row) != len(header):
            raise _wrong(
                path, number, header[min(len(row), len(header) - 1)], f"{len(row)} values for {len(header)} columns"
            )
        _add(fibers, [row[k] for k in columns], per_meter, [header[k] for k in columns], path, number)
    _close(fibers, path)
    if not fibers.names:
        raise _wrong(path, number, header[columns[0]], "no fiber follows the header")
    if side is not None and notes.plan is not None:
        raise CaseError(f"{path} states its own plan; leave mat.side out")
    plan = (side, side) if side is not None else notes.plan
    return _mat(fibers, plan, notes.thickness, bool(notes.periodic if periodic is None else periodic), path)


def _rows(text: str, notes: _Notes, path: Path) -> Iterator[tuple[int, list[str]]]:
    """Give the rows with their line numbers, and keep what the comments among them state."""
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip():
            continue
        if not line.lstrip().startswith("#"):
            try:
                yield number, [value.strip() for value in next(csv.reader([line]))]
            except csv.Error as problem:
                # as a value of more than 131072 letters
                raise CaseError(f"{path}, line {number}: {problem}") from None
        elif (note := _NOTE.fullmatch(line.strip())) is not None:
            _read_note(note["key"], note["value"], notes, path, number)


def _read_note(key: str, value: str, notes: _Notes, path: Path, number: int) -> None:
    try:
        if key == "plan":
            x, y = (parse(part.strip(), "m") for part in value.split(" x "))
            notes.plan = (x, y)
        elif key == "thickness":
            notes.thickness = parse(value, "m")
        else:
            notes.periodic = {"yes": True, "no": False}[value]
    except (ValueError, KeyError):
        example = {"plan": "100 um x 100 um", "thickness": "46.4 um", "periodic": "yes"}[key]
        raise CaseError(f"{path}, line {number}: write # {key}: {example}, not {value!r}") from None


def _read_header(header: list[str], path: Path, number: int) -> tuple[list[int], list[float]]:
    """Find the place of each column, and how many of its units make a meter."""
    places: dict[str, int] = {}
    per_meter: dict[str, float] = {}
    for place, text in enumerate(header):
        match = _HEADER.fullmatch(text)
        name = match["name"] if match is not None else text
        if match is None or name not in _COLUMNS:
            raise _wrong(path, number, text, f"unknown column; known: {', '.join(_COLUMNS)}")
        if name in places:
            raise _wrong(path, number, text, "a column stands twice")
        places[name] = place
        if name != "fiber":
            try:
                unit = parse(f"1 {match['unit'] or ''}", "m")
            except ValueError:
                raise _wrong(path, number, text, f"write the column's unit as {name} [um]") from None
            # 500 / 1e9 is the float 5e-7, 500 * 1e-9 is not
            per_meter[name] = float(f"{1.0 / unit:.15g}")
    missing = [name for name in _COLUMNS if name not in places]
    if missing:
        raise _wrong(path, number, missing[0], "missing from the header, which names fiber, x, y, z and radius")
    return [places[name] for name in _COLUMNS], [per_meter[name] for name in _COLUMNS[1:]]


def _add(fibers: _Fibers, row: list[str], per_meter: list[float], header: list[str], path: Path, number: int) -> None:
    """Add one point, to the last fiber or to a new one."""
    values = []
    for text, units, column in zip(row[1:], per_meter, header[1:], strict=True):
        try:
            value = float(text) / units
        except ValueError:
            raise _wrong(path, number, column, f"{text!r} is not a number") from None
        if not np.isfinite(value):
            raise _wrong(path, number, column, f"{text!r} is not a finite number")
        values.append(value)
    x, y, z, radius = values
    if radius <= 0:
        raise _wrong(path, number, header[4], f"a radius must be above 0, not {row[4]}")
    if not fibers.names or row[0] != fibers.names[-1]:
        _close(fibers, path)
        if row[0] in fibers.seen:
            raise _wrong(path, number, header[0], f"fiber {row[0]} goes on after another one: keep its points together")
        fibers.seen.add(row[0])
        fibers.names.append(row[0])
        fibers.first.append(len(fibers.nodes))
        fibers.radius.append(radius)
    elif radius != fibers.radius[-1]:
        raise _wrong(path, number, header[4], f"fiber {row[0]} changes its radius: one fiber has one")
    elif fibers.nodes[-1] == (x, y, z):
        raise _wrong(path, number, header[1], f"fiber {row[0]} has the same point twice in a row")
    fibers.nodes.append((x, y, z))
    fibers.lines.append(number)


def _close(fibers: _Fibers, path: Path) -> None:
    if fibers.names and len(fibers.nodes) - fibers.first[-1] < 2:
        raise _wrong(path, fibers.lines[-1], "fiber", f"fiber {fibers.names[-1]} has only one point")


def _mat(fibers: _Fibers, plan: tuple[float, float] | None, thickness: float | None, periodic: bool, path: Path) -> Mat:
    nodes: Floats = np.array(fibers.nodes)
    radius = np.array(fibers.radius)
    first = np.array([*fibers.first, len(nodes)])
    around = np.repeat(radius, np.diff(first))
    if plan is None:
        nodes[:, :2] -= nodes[:, :2].min(axis=0)
        plan = (float(nodes[:, 0].max()), float(nodes[:, 1].max()))
    if thickness is None:
        nodes[:, 2] -= (nodes[:, 2] - around).min()
        thickness = float((nodes[:, 2] + around).max())
    size = (*plan, thickness)
    for axis, name in enumerate("xyz"):
        if size[axis] <= 0:
            raise CaseError(f"{path}: the slab has no extent along {name}; state # plan: and # thickness:")
        outside = np.flatnonzero((nodes[:, axis] < 0) | (nodes[:, axis] > size[axis]))
        if len(outside) and (name == "z" or not periodic):
            value = f"{nodes[outside[0], axis] * _PER_METER:g} um lies outside 0 to {size[axis] * _PER_METER:g} um"
            more = f", and so do {len(outside) - 1} more points" if len(outside) > 1 else ""
            raise _wrong(path, fibers.lines[outside[0]], name, value + more)
    return Mat(
        nodes, first, radius, Box((0.0, 0.0, 0.0), size), seed=-1, origin=f"read from {path.name}", periodic=periodic
    )


def _wrong(path: Path, line: int, column: str, reason: str) -> CaseError:
    return CaseError(f"{path}, line {line}, column {column}: {reason}")
