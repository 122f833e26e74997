"""Folders of runs as strangers, kills and disks leave them: damaged files, links, pipes and folders in any place.

A run in such a folder must end in the very results of an untouched one, or in an error of ours, and must neither write
nor remove anything outside.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import math
import os
import shutil
import types
import typing
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

from pipeline.case import Case, validate
from pipeline.enclosure.duct import enclose
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.errors import StageError
from pipeline.line import store
from pipeline.line.manifest import read_manifest
from pipeline.line.places import MANIFEST, remove
from pipeline.line.run import LINE, Run, run
from pipeline.nouns.convergence import ConvergedDrop
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow_field import EDGES, FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.micrographs import Micrographs
from pipeline.nouns.quality import CellFields
from pipeline.nouns.surface import Surface
from pipeline.quality.judge import judge
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite
from tests.sample_meshes import duct
from tests.security.inputs import damaged, folder, in_time, refused_or_read
from tests.surface.mats import CROSSING

STAGES = ("mat", "surface", "enclosure")
RESULTS = ("mat/mat.npz", "surface/surface.npz", "enclosure/domain.npz")
_ODD = st.one_of(
    st.none(), st.booleans(), st.text(max_size=5), st.floats(),
    st.sampled_from([0, -1, 3, 2**31, 2**63 - 1, 2**70, 10**400, 1e308, [], [[1]], {}, {"a": 1}, "nan"]),
)  # fmt: skip
_WAYS = ("damage", "remove", "link", "link to a file", "nowhere", "pipe", "folder", "second name")
_KINDS = st.sampled_from(["f8", "i8", "f4", "i4", "u1", "U3", "?", "c16", "S2"])


@cache
def case() -> Case:
    """Give a mat of one fiber, whose stages take hundredths of a second."""
    mat = {"generator": "array", "arrangement": "square", "solidity": "10 %", "fiber_diameter": "1 um", "rows": 1}
    return validate({"mat": mat, "enclosure": {"inlet": "2 um", "outlet": "2 um"}}, "the fuzzer's case")


@cache
def untouched() -> Path:
    """Give a run folder that is whole."""
    place = folder() / "untouched"
    run(case(), place, until="enclosure")
    return place


@cache
def nouns() -> dict[str, tuple[type, bytes]]:
    """Give a file of each noun with arrays, by its name, and what is read from it."""
    surface = unite(CROSSING, SurfaceSettings())
    things = {
        "mat.npz": CROSSING,
        "surface.npz": surface,
        "domain.npz": enclose(surface, EnclosureSettings()),
        "mesh.npz": duct((2, 2, 3)).face_mesh(),
        "fields.npz": CellFields(("determinant",), np.zeros((1, 12))),
        "flow.npz": _flow(),
    }
    assert {type(thing) for thing in things.values()} == set(_left_as(".npz")), "a noun is not looked at"
    found: dict[str, tuple[type, bytes]] = {}
    for name, thing in things.items():
        store.save(thing, folder() / name)
        found[name] = (type(thing), (folder() / name).read_bytes())
        # what is asked first compiles for a while, which is no fault of an input's
        _ASKED[type(thing)](thing)
    return found


def _flow() -> FlowField:
    corners = np.concatenate([np.zeros((1, 3)), np.eye(3)])
    nodes = np.concatenate([corners, corners[EDGES].mean(axis=1)])
    return FlowField(nodes, np.arange(10)[None], np.ones((10, 3)), np.ones(4), np.array([False]), 1e-7)


def _left_as(suffix: str) -> list[type]:
    """Give the nouns that the stages of the line leave in files of a kind."""
    return [noun for stage in LINE for noun, place in stage.gives.items() if place.endswith(suffix)]


@cache
def json_nouns() -> dict[str, tuple[type, bytes]]:
    """Give a valid file of each noun that is left as JSON, made from its types alone."""
    found = {}
    for kind in (*_left_as(".json"), ConvergedDrop):
        path = folder() / "noun.json"
        store.write_json(path, _example(kind))
        found[kind.__name__] = (kind, path.read_bytes())
    return found


def _example(kind: Any) -> Any:
    parts = typing.get_args(kind)
    origin = typing.get_origin(kind)
    if dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind)
        if kind is Micrographs:
            # only its own two names are taken
            return Micrographs("twin.png", None, 1.0, 1.0, 1.0)
        return kind(**{item.name: _example(hints[item.name]) for item in dataclasses.fields(kind)})  # type: ignore[operator]
    if origin in (types.UnionType, typing.Union):
        return None if type(None) in parts else _example(parts[0])
    if origin is tuple:
        return (_example(parts[0]),) * 2 if Ellipsis in parts else tuple(map(_example, parts))
    if origin is dict:
        return {"a": _example(parts[1])}
    # none of no particles have no end
    return {float: 0.5, int: 0, bool: True, str: "a"}[kind]


# what every noun answers once it is there
_ASKED: dict[type, Callable[[Any], object]] = {
    Mat: lambda mat: (mat.segment_lengths(), mat.slab.volume),
    Surface: lambda surface: (surface.volume, surface.solidity),
    FluidDomain: lambda domain: (domain.volume, domain.mean_diameter),
    FaceMesh: lambda mesh: (mesh.volume, judge(mesh)),
    CellFields: lambda fields: fields.by_name(),
    FlowField: lambda flow: [
        ask(np.arange(len(flow.cells)), np.full((len(flow.cells), 4), 0.25))
        for ask in (flow.place, flow.velocity_at, flow.pressure_at)
    ],
}


def damaged_noun(draw: st.DataObject) -> None:
    """Damage the bytes of an `.npz`."""
    name = draw.draw(st.sampled_from(sorted(nouns())))
    kind, content = nouns()[name]
    path = folder() / f"input-{name}"
    path.write_bytes(damaged(draw, content))
    with refused_or_read():
        _ASKED[kind](store.load(kind, path))


def odd_arrays(draw: st.DataObject) -> None:
    """Write other arrays, of other shapes, types and values, under the names of a noun's, in a sound archive."""
    name = draw.draw(st.sampled_from(sorted(nouns())))
    kind, content = nouns()[name]
    source, path = folder() / f"source-{name}", folder() / f"odd-{name}"
    source.write_bytes(content)
    arrays: dict[str, Any] = dict(store.read_arrays(source))
    for _ in range(draw.draw(st.integers(1, 2))):
        hit = draw.draw(st.sampled_from(sorted(arrays)))
        if hit == "rest":
            rest = json.loads(str(arrays["rest"]))
            rest[draw.draw(st.sampled_from([*sorted(rest), "more"]))] = draw.draw(_ODD)
            arrays["rest"] = np.array(json.dumps(rest))
        else:
            arrays[hit] = _other(draw, arrays[hit])
    np.savez(path, **arrays)
    with refused_or_read():
        _ASKED[kind](store.load(kind, path))


def _other(draw: st.DataObject, array: Any) -> Any:
    array = np.atleast_1d(array)
    match draw.draw(st.sampled_from(["value", "type", "flat", "deeper", "cut", "doubled", "empty", "scalar"])):
        case "value":
            changed = array.copy()
            if changed.size:
                odd = [0, -1, 7, 2**62] if changed.dtype.kind == "i" else [0.0, -1.0, math.nan, math.inf, 1e300]
                changed.reshape(-1)[draw.draw(st.integers(0, changed.size - 1))] = draw.draw(st.sampled_from(odd))
            return changed
        case "type":
            kind = draw.draw(_KINDS)
            return (
                np.zeros(array.shape, kind) if array.dtype.kind in "US" or kind in ("U3", "S2") else array.astype(kind)
            )
        case "flat":
            return array.reshape(-1)
        case "deeper":
            return array[None]
        case "cut":
            return array[: draw.draw(st.integers(0, len(array)))]
        case "doubled":
            return np.concatenate([array, array])
        case "empty":
            return array[:0]
        case _:
            return np.array(array.reshape(-1)[0] if array.size else 0)


def lying_header(draw: st.DataObject) -> None:
    """Let an array's header, or the archive's, speak of other sizes than are there."""
    name = draw.draw(st.sampled_from(sorted(nouns())))
    kind, content = nouns()[name]
    source, path = folder() / f"source-{name}", folder() / f"lying-{name}"
    source.write_bytes(content)
    with zipfile.ZipFile(source) as archive:
        entries = {entry.filename: archive.read(entry) for entry in archive.infolist()}
    hit = draw.draw(st.sampled_from(sorted(entries)))
    shape = draw.draw(st.sampled_from(["(6000000000,)", "(2, 3000000000)", "(-1, 3)", "(0, 99999999999)", "3", "()"]))
    header = entries[hit][:128]
    start, end = header.index(b"(") if b"(" in header else 60, header.rindex(b")") + 1
    told = (header[:start] + shape.encode())[: 128 - len(header[end:].strip())] + header[end:].strip()
    entries[hit] = told.ljust(127)[:127] + b"\n" + entries[hit][128:]
    way = draw.draw(st.sampled_from([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED]))
    with zipfile.ZipFile(path, "w", way) as archive:
        for each, data in entries.items():
            archive.writestr(each, data)
    with refused_or_read():
        _ASKED[kind](store.load(kind, path))


def odd_manifest(draw: st.DataObject) -> None:
    """Put something else into a manifest, which a run must then not believe."""
    place = _copy()
    stage = draw.draw(st.sampled_from(STAGES))
    path = place / stage / MANIFEST
    content = json.loads(path.read_text())
    for _ in range(draw.draw(st.integers(1, 2))):
        table: Any = content
        while True:
            key = draw.draw(st.sampled_from([*sorted(table), "more", "/dev/zero", "../../outside"]))
            if isinstance(table.get(key), dict) and table[key] and draw.draw(st.booleans()):
                table = table[key]
                continue
            table[key] = draw.draw(_ODD)
            break
    path.write_text(json.dumps(content))
    _run_again(place)


def odd_json(draw: st.DataObject) -> None:
    """Damage the JSON of a noun, or put something else anywhere into it."""
    kind, content = json_nouns()[draw.draw(st.sampled_from(sorted(json_nouns())))]
    path = folder() / "odd.json"
    if draw.draw(st.booleans()):
        path.write_bytes(damaged(draw, content))
    else:
        whole = json.loads(content)
        table: Any = whole
        while True:
            key = draw.draw(st.sampled_from(sorted(table) if isinstance(table, dict) else range(len(table))))
            if isinstance(table[key], dict | list) and table[key] and draw.draw(st.booleans()):
                table = table[key]
                continue
            table[key] = draw.draw(_ODD)
            break
        path.write_text(json.dumps(whole))
    with refused_or_read():
        store.write_json(folder() / "again.json", store.load_json(kind, path))


def _copy() -> Path:
    place = folder() / "run-of-somebody"
    remove(place)
    shutil.copytree(untouched(), place)
    return place


def _outside() -> Path:
    outside = folder() / "outside"
    remove(outside)
    (outside / "deep").mkdir(parents=True)
    (outside / "thesis").write_text("three years")
    (outside / "deep" / "data").write_text("more")
    return outside


def broken_folder(draw: st.DataObject) -> None:
    """Put links, pipes, folders, files and damage into any places of a run's folder, and run it."""
    place, outside = _copy(), _outside()
    before = _content(outside)
    files = sorted(str(path.relative_to(place)) for path in place.rglob("*"))
    more = [f".{stage}.{word}" for stage in STAGES for word in ("partial", "old", "kept")]
    for _ in range(draw.draw(st.integers(1, 4))):
        hit = place / draw.draw(st.sampled_from([*files, *more, ".case.json.new", "report", ".report.partial"]))
        content = hit.read_bytes() if hit.is_file() and not hit.is_symlink() else b"something"
        # a link of the last turn leads outside, where nothing may be put from here either
        if not hit.parent.is_dir() or not hit.parent.resolve().is_relative_to(place.resolve()):
            continue
        way = draw.draw(st.sampled_from(_WAYS))
        remove(hit)
        match way:
            case "damage":
                hit.write_bytes(damaged(draw, content))
            case "link":
                hit.symlink_to(outside)
            case "link to a file":
                hit.symlink_to(outside / "thesis")
            case "nowhere":
                hit.symlink_to(outside / "nothing")
            case "pipe":
                os.mkfifo(hit)
            case "folder":
                (hit / "inner").mkdir(parents=True)
                (hit / "inner" / "out").symlink_to(outside)
            case "second name":
                os.link(outside / "thesis", hit)
    for noun in (Mat, Surface, FluidDomain):
        with refused_or_read():
            Run.opened(place).get(noun)
    _run_again(place)
    assert _content(outside) == before


def _run_again(place: Path) -> None:
    with in_time():
        try:
            run(case(), place, until="enclosure")
        except StageError as problem:
            # only a folder in the place of the run's own two files is left to the user
            if ".lock" in str(problem) or "case.json" in str(problem):
                return
            raise AssertionError(f"a stage was not made again: {problem}") from problem
    for name in RESULTS:
        assert (place / name).read_bytes() == (untouched() / name).read_bytes(), name
    assert not [path.name for path in place.iterdir() if path.suffix in (".partial", ".old", ".kept", ".new")]
    # and what is there is told without a traceback
    with refused_or_read():
        opened = Run.opened(place)
        for stage in STAGES:
            assert read_manifest(opened.folder / stage) is not None


def _content(place: Path) -> dict[str, bytes]:
    return {str(path.relative_to(place)): path.read_bytes() for path in place.rglob("*") if path.is_file()}


TARGETS: dict[str, Callable[[st.DataObject], None]] = {
    "result of a stage, damaged": damaged_noun,
    "result of a stage, other arrays": odd_arrays,
    "result of a stage, headers that lie": lying_header,
    "result of a stage in JSON, damaged": odd_json,
    "run folder, odd manifests": odd_manifest,
    "run folder, links, pipes and damage": broken_folder,
}
