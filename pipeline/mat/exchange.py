"""Fibers from text: CSV whose columns name their units (docs/mat.md)."""

# SPDX-License-Identifier: GPL-3.0-or-later

import csv
import errno
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from pipeline.cad.fibers import COLUMNS as _COLUMNS
from pipeline.cad.lengths import Unit, in_meters, in_micrometers, unit_of
from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.geometry.triangles import Floats, Ints
from pipeline.mat.fiber_notes import Notes
from pipeline.mat.windows import cut_to
from pipeline.nouns.fibers import Mat
from pipeline.progress import Progress, silent
from pipeline.reading import read_bytes

_HEADER = re.compile(r"\s*(?P<name>\w+)\s*(?:\[\s*(?P<unit>[^\]]+?)\s*\])?\s*")
_MOST_VARIED = 2.0
"""Ratio of a fiber's largest radius to its smallest beyond which no single radius stands for it."""

LARGEST_FILE = 200_000_000
"""No file of fibers is larger than this many bytes: as Python's own numbers its points take ten times as much."""


@dataclass
class _Fibers:
    """Points as read, with the line each stood on."""

    nodes: list[tuple[float, float, float]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    radius: list[float] = field(default_factory=list)
    first: list[int] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    seen: set[str] = field(default_factory=set)
    shapes: dict[tuple[tuple[float, float, float], ...], int] = field(default_factory=dict)


def read_fibers(
    path: Path,
    side: float | None = None,
    periodic: bool | None = None,
    outside: Literal["refuse", "cut"] = "refuse",
    progress: Progress = silent,
) -> Mat:
    """Read center lines from CSV.

    Parameters
    ----------
    path : Path
        Columns fiber, x, y, z and radius, in any order, with their units in the header, as ``x [um]``.
    side : float, optional [m]
        Edge of the square plan, from (0, 0), where the file states none.
    periodic : bool, optional
        Whether the plan wraps; unless given, what the file says, or no.
    outside : {"refuse", "cut"}
        What becomes of axes that leave the slab: an error, or they end where they leave it.
    progress : Progress

    Returns
    -------
    Mat
        Where neither `side` nor the file states a plan, the fibers are moved so that the smallest rectangle around
        the center lines starts at (0, 0); where the file states no thickness, so that the lowest surface lies at
        z = 0. A fiber whose radius varies gets the one that keeps its volume.

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
    notes, fibers = Notes(), _Fibers()
    rows = _rows(text, notes, path)
    number, header = next(rows, (1, []))
    columns, units = _read_header(header, path, number)
    for number, row in rows:
        if len(row) != len(header):
            raise _wrong(
                path, number, header[min(len(row), len(header) - 1)], f"{len(row)} values for {len(header)} columns"
            )
        _add(fibers, [row[k] for k in columns], units, [header[k] for k in columns], path, number)
    _close(fibers, path)
    if not fibers.names:
        raise _wrong(path, number, header[columns[0]], "no fiber follows the header")
    if side is not None and notes.plan is not None:
        raise CaseError(f"{path} states its own plan; leave mat.side out")
    plan = (side, side) if side is not None else notes.plan
    wraps = bool(notes.periodic if periodic is None else periodic)
    if wraps and outside == "cut":
        raise CaseError(f"{path}: a periodic plan cuts no fiber; leave mat.outside out, or set mat.periodic = false")
    return _mat(fibers, plan, notes.thickness, wraps, path, outside == "cut", progress)


def _rows(text: str, notes: Notes, path: Path) -> Iterator[tuple[int, list[str]]]:
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
        else:
            notes.read(line.strip(), path, number)


def _read_header(header: list[str], path: Path, number: int) -> tuple[list[int], list[Unit]]:
    """Find the place of each column, and the units of the four lengths."""
    places: dict[str, int] = {}
    units: dict[str, Unit] = {}
    for place, text in enumerate(header):
        match = _HEADER.fullmatch(text)
        name = match["name"].lower() if match is not None else text
        if match is None or name not in _COLUMNS:
            raise _wrong(path, number, text, f"unknown column; known: {', '.join(_COLUMNS)}")
        if name in places:
            raise _wrong(path, number, text, "a column stands twice")
        places[name] = place
        if name != "fiber":
            try:
                units[name] = unit_of(match["unit"] or "")
            except ValueError:
                raise _wrong(path, number, text, f"write the column's unit as {name} [um]") from None
    missing = [name for name in _COLUMNS if name not in places]
    if missing:
        raise _wrong(path, number, missing[0], "missing from the header, which names fiber, x, y, z and radius")
    return [places[name] for name in _COLUMNS], [units[name] for name in _COLUMNS[1:]]


def _add(fibers: _Fibers, row: list[str], units: list[Unit], header: list[str], path: Path, number: int) -> None:
    """Add one point, to the last fiber or to a new one."""
    values = []
    for text, unit, column in zip(row[1:], units, header[1:], strict=True):
        try:
            values.append(in_meters(text, unit))
        except ValueError as problem:
            raise _wrong(path, number, column, str(problem)) from None
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
    elif fibers.nodes[-1] == (x, y, z):
        raise _wrong(path, number, header[1], f"fiber {row[0]} has the same point twice in a row")
    fibers.nodes.append((x, y, z))
    fibers.lines.append(number)
    fibers.radius.append(radius)


def _close(fibers: _Fibers, path: Path) -> None:
    """Check the last fiber as a whole."""
    if not fibers.names:
        return
    name, begin = fibers.names[-1], fibers.first[-1]
    if len(fibers.nodes) - begin < 2:
        raise _wrong(path, fibers.lines[-1], "fiber", f"fiber {name} has only one point")
    smallest, largest = min(fibers.radius[begin:]), max(fibers.radius[begin:])
    if largest > _MOST_VARIED * smallest:
        reason = (
            f"fiber {name} changes its radius from {smallest * 1e6:.4g} to {largest * 1e6:.4g} um, {_MOST_VARIED:g} "
            "times and more: no single radius stands for it; split the fiber where it changes"
        )
        raise _wrong(path, fibers.lines[begin + fibers.radius[begin:].index(largest)], "radius", reason)
    points = tuple(fibers.nodes[begin:])
    twin = fibers.shapes.setdefault(min(points, points[::-1]), begin)
    if twin != begin:
        reason = f"fiber {name} has the same points as the one on line {fibers.lines[twin]}: leave one of them out"
        raise _wrong(path, fibers.lines[begin], "fiber", reason)


def _mat(
    fibers: _Fibers,
    plan: tuple[float, float] | None,
    thickness: float | None,
    periodic: bool,
    path: Path,
    cut: bool,
    progress: Progress,
) -> Mat:
    nodes: Floats = np.array(fibers.nodes)
    first = np.array([*fibers.first, len(nodes)])
    radius = _volume_radius(nodes, first, np.array(fibers.radius), progress)
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
        if len(outside) and (name == "z" or not periodic) and not cut:
            value = (
                f"{in_micrometers(float(nodes[outside[0], axis]))} um lies outside 0 to {in_micrometers(size[axis])} um"
            )
            more = f", and so do {len(outside) - 1} more points" if len(outside) > 1 else ""
            raise _wrong(path, fibers.lines[outside[0]], name, f'{value}{more}; mat.outside = "cut" cuts them there')
    slab, origin = Box((0.0, 0.0, 0.0), size), f"read from {path.name}"
    if cut:
        whole = len(radius)
        nodes, first, owner = cut_to(slab, nodes, first)
        if len(owner) == 0:
            raise CaseError(f"{path}: none of the {whole} fibers has its axis within the slab of {size} m")
        radius, kept = radius[owner], len(np.unique(owner))
        origin += f", cut at the slab: {len(owner)} pieces of {kept} of its {whole} fibers lie within"
        progress(f"cut at the slab: {len(owner)} pieces of {kept} of {whole} fibers lie within")
    return Mat(nodes, first, radius, slab, seed=-1, origin=origin, periodic=periodic)


def _volume_radius(nodes: Floats, first: Ints, radius: Floats, progress: Progress) -> Floats:
    """Give each fiber the radius with which its cylinders have the volume of the cones between its points."""
    length = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    # no cone leads from one fiber to the next
    length[first[1:-1] - 1] = 0.0
    before, after = radius[:-1], radius[1:]
    cones = length * (before**2 + before * after + after**2) / 3.0
    mean = np.sqrt(np.add.reduceat(cones, first[:-1]) / np.add.reduceat(length, first[:-1]))
    lowest, highest = np.minimum.reduceat(radius, first[:-1]), np.maximum.reduceat(radius, first[:-1])
    varied = lowest < highest
    if varied.any():
        most = float((highest / lowest).max() - 1.0)
        progress(f"{int(varied.sum())} fibers vary in radius, by up to {most:.0%}: each gets the one of its volume")
    return np.where(varied, mean, lowest)


def _wrong(path: Path, line: int, column: str, reason: str) -> CaseError:
    return CaseError(f"{path}, line {line}, column {column}: {reason}")
