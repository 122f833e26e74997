"""Files of strangers: what a careless or a hostile person could hand to a reader, drawn by hypothesis.

Each target takes one drawn input and holds if the reader gives a result or a `FibertwinError`, in time. The tests draw
a few hundred; ``python -m tests.security.fuzz 20000`` draws as many as one likes and says how many there were.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import json
import shutil
import signal
import tempfile
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import FrameType

import numpy as np
from hypothesis import strategies as st

from pipeline.analytics.options import read_options
from pipeline.case import override, read_case, read_toml, validate
from pipeline.cli.bundled import bundled
from pipeline.cli.starting import first_case
from pipeline.errors import FibertwinError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.read import read_mesh
from pipeline.export.settings import ExportSettings, Format
from pipeline.export.write import export
from pipeline.line.run import Run
from pipeline.mat.exchange import read_fibers
from pipeline.quality.judge import judge
from pipeline.study.settings import read_study
from pipeline.units import parse
from tests.export.dialects import DIALECTS
from tests.openfoam import AIR
from tests.sample_meshes import duct

LONGEST, PATIENCE = 20, 200  # seconds that any small input may keep a reader busy, and waiting

JUNK = st.one_of(
    st.binary(max_size=12),
    st.sampled_from(
        [b"-1", b" 99999999 ", b" 2000000000 ", b"9" * 40, b"nan", b"1e999", b"(", b")", b"{", b'"', b"\n", b"\x00",
         b"\xff\xfe", b"\x1b[2J", b"../../etc/passwd", b'#include "/etc/passwd"', b"$(id)", b"7fffffff",
         b"\xef\xbb\xbf"]
    ),
)  # fmt: skip
TEXTS = st.one_of(
    st.text(max_size=30),
    st.from_regex(r"[-+]?[0-9]{1,5}(\.[0-9]{0,5})?(e[-+]?[0-9]{1,3})? ?[a-zA-Zµ%^*/ 0-9-]{0,24}", fullmatch=True),
    st.sampled_from(
        ["9^9^9^9 m", "1 m**9**9**9", "1 degC/degC", "1e308 km", "-0 um", "1 " + "m*" * 20, "٣ um", "1 m²"]
    ),
)
VALUES = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), TEXTS),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=8,
)


@contextlib.contextmanager
def in_time() -> Iterator[None]:
    """Hold if the block ends within seconds of the processor, since others may be busy too, and of the clock."""

    def late(number: int, frame: FrameType | None) -> None:
        raise AssertionError(f"a reader was still busy after {LONGEST} s, or waited for {PATIENCE} s")

    limits = ((signal.SIGPROF, signal.ITIMER_PROF, LONGEST), (signal.SIGALRM, signal.ITIMER_REAL, PATIENCE))
    before = [signal.signal(number, late) for number, _, _ in limits]
    for _, timer, seconds in limits:
        signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        for (number, timer, _), handler in zip(limits, before, strict=True):
            signal.setitimer(timer, 0.0)
            signal.signal(number, handler)


@contextlib.contextmanager
def refused_or_read() -> Iterator[None]:
    """Hold if the block ends, or ends in an error that is ours and that a terminal can show."""
    # what numpy mutters about a stranger's huge numbers is no failure; the reader's answer counts
    with warnings.catch_warnings(), in_time():
        warnings.simplefilter("ignore")
        told = "a result"
        try:
            yield
        except FibertwinError as problem:
            told = str(problem)
        assert 0 < len(told) < 20_000


@cache
def folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="fibertwin-fuzz-"))


@cache
def seeds() -> dict[str, bytes]:
    """Give valid files, to be damaged, by their names."""
    found = {f"{name.replace('/', '-')}.toml": path.read_bytes() for name, path in bundled().items()}
    found |= {f"first-{name}.toml": first_case(name).encode() for name in ("layered", "box", "array", "file")}
    found["fibers.csv"] = (
        b"# plan: 10 um x 10 um\n# thickness: 3 um\n# periodic: no\nfiber,x [um],y [um],z [um],radius [nm]\n"
        b"a,0,5,1,500\na,5,5,1.2,500\na,10,5,1,500\nb,5,0,2,400\nb,5,10,2,400\n"
    )
    made = folder() / "made"
    mesh = duct((3, 3, 5)).face_mesh()
    kinds: tuple[Format, ...] = ("vtk", "fluent", "gmsh", "abaqus", "nastran", "su2", "medit")
    export(mesh, made, ExportSettings(formats=kinds), AIR, "symmetry")
    found |= {f"{path.parent.name}{path.suffix}": path.read_bytes() for path in made.glob("*/mesh.*[!m]")}
    found["vtk.vtu"] = (made / "vtk/internal.vtu").read_bytes()
    found["polyhedra.vtu"] = _mixed_vtu(newer=False)
    found["newer.vtu"] = _mixed_vtu(newer=True)
    return found


def _mixed_vtu(newer: bool) -> bytes:
    """Give a hexahedron and a polyhedron in one file, as text, so that damage hits numbers."""
    faces = "6 4 4 6 7 5 4 8 9 11 10 4 4 5 9 8 4 5 7 11 9 4 7 6 10 11 4 6 4 8 10"
    points = " ".join(f"{x} {y} {z}" for z in (0, 1, 2) for y in (0, 1) for x in (0, 1))
    arrays = {
        "connectivity": ("Int64", "0 1 3 2 4 5 7 6 4 5 6 7 8 9 10 11"), "offsets": ("Int64", "8 16"),
        "types": ("UInt8", "12 42"), "faces": ("Int64", faces), "faceoffsets": ("Int64", "-1 31"),
    }  # fmt: skip
    if newer:
        arrays |= {
            "face_connectivity": ("Int64", "4 6 7 5 8 9 11 10 4 5 9 8 5 7 11 9 7 6 10 11 6 4 8 10"),
            "face_offsets": ("Int64", "4 8 12 16 20 24"),
            "polyhedron_to_faces": ("Int64", "0 1 2 3 4 5"), "polyhedron_offsets": ("Int64", "0 6"),
        }  # fmt: skip
    cells = "".join(
        f'<DataArray type="{kind}" Name="{name}" format="ascii">\n{text}\n</DataArray>\n'
        for name, (kind, text) in arrays.items()
    )
    return (
        f'<VTKFile type="UnstructuredGrid" version="{"2.3" if newer else "0.1"}" '
        'byte_order="LittleEndian">\n<UnstructuredGrid>\n'
        '<Piece NumberOfPoints="12" NumberOfCells="2">\n<Points>\n<DataArray type="Float64" Name="Points" '
        f'NumberOfComponents="3" format="ascii">\n{points}\n</DataArray>\n</Points>\n<Cells>\n{cells}</Cells>\n'
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    ).encode()


@cache
def polymesh(encoding: str) -> dict[str, bytes]:
    place = folder() / f"foam-{encoding}"
    write_openfoam(duct((3, 3, 5)).face_mesh(), place, AIR, settings=ExportSettings(encoding=encoding))  # type: ignore[arg-type]
    return {path.name: path.read_bytes() for path in sorted((place / "constant/polyMesh").iterdir())}


def damaged(draw: st.DataObject, content: bytes) -> bytes:
    """Change, cut or double a file in up to three places."""
    for _ in range(draw.draw(st.integers(1, 3))):
        at = int(draw.draw(st.floats(0, 1)) * len(content))
        junk = draw.draw(JUNK)
        match draw.draw(st.sampled_from(["replace", "insert", "cut", "double", "delete"])):
            case "replace":
                content = content[:at] + junk + content[at + len(junk) :]
            case "insert":
                content = content[:at] + junk + content[at:]
            case "cut":
                content = content[:at] + junk
            case "double":
                content = content[:at] + content[at : at + 400] + content[at:]
            case _:
                content = content[:at] + content[at + draw.draw(st.integers(1, 40)) :]
    return content


def _written(draw: st.DataObject, suffix: str) -> Path:
    name = draw.draw(st.sampled_from(sorted(name for name in seeds() if name.endswith(suffix))))
    path = folder() / f"input-{name}"
    path.write_bytes(damaged(draw, seeds()[name]))
    return path


def units(draw: st.DataObject) -> None:
    text, unit = draw.draw(TEXTS), draw.draw(st.sampled_from(["m", "m/s", "kelvin", "Pa", "byte", "degree", ""]))
    with in_time(), contextlib.suppress(ValueError):
        assert isinstance(parse(text, unit), float)


def damaged_case(draw: st.DataObject) -> None:
    path = _written(draw, ".toml")
    with refused_or_read():
        read_case(path)


def damaged_study(draw: st.DataObject) -> None:
    path = _written(draw, ".toml")
    with refused_or_read():
        read_study(path)


def odd_values(draw: st.DataObject) -> None:
    """Put something else in the place of any key of a valid case."""
    path = draw.draw(st.sampled_from(sorted(name for name in seeds() if name.startswith("first-"))))
    place = folder() / "whole.toml"
    place.write_bytes(seeds()[path])
    content = read_toml(place)
    for _ in range(draw.draw(st.integers(1, 3))):
        table = content.setdefault(draw.draw(st.sampled_from([*content, "mat", "flow", "tetmesh", "x"])), {})
        if isinstance(table, dict):
            table[draw.draw(st.sampled_from([*table, "fiber_diameter", "stop", "orientation", "edge", ""]))] = (
                draw.draw(VALUES)
            )
    with refused_or_read():
        validate(content, "a case")


def overrides(draw: st.DataObject) -> None:
    keys = st.sampled_from(
        ["mat.seed", "mat.stop.coverage", "mat.fiber_diameter", "tetmesh.edge", "a." * 3000, "mat", ""]
    )
    text = draw.draw(st.one_of(st.text(max_size=40), st.builds("{}={}".format, keys, TEXTS | st.just("[" * 3000))))
    place = folder() / "whole.toml"
    place.write_bytes(seeds()["first-layered.toml"])
    with refused_or_read():
        validate(override(read_toml(place), (text,)), "--set")


def options(draw: st.DataObject) -> None:
    names = st.sampled_from(["solidity", "thickness", "fiber_diameter", "face_velocity", "preset", "temperature", "x"])
    with refused_or_read():
        read_options(draw.draw(st.dictionaries(names, TEXTS, max_size=5)))


def fibers(draw: st.DataObject) -> None:
    path = _written(draw, ".csv")
    with refused_or_read():
        read_fibers(path)


def mesh_file(draw: st.DataObject) -> None:
    path = _written(draw, draw.draw(st.sampled_from([".msh", ".vtu", ".inp", ".bdf", ".su2", ".mesh"])))
    with refused_or_read():
        judge(read_mesh(path))


def damaged_dialect(draw: st.DataObject) -> None:
    """Damage a file of a random mesh as some program or person would write it."""
    place = folder() / "dialect"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    make = DIALECTS[draw.draw(st.sampled_from(sorted(DIALECTS)))]
    path, _ = make(np.random.default_rng(draw.draw(st.integers(0, 2**32 - 1))), place)
    hit = draw.draw(st.sampled_from(sorted(file for file in place.rglob("*") if file.is_file())))
    hit.write_bytes(damaged(draw, hit.read_bytes()))
    with refused_or_read():
        judge(read_mesh(path))


def openfoam_mesh(draw: st.DataObject) -> None:
    files = polymesh(draw.draw(st.sampled_from(["ascii", "binary"])))
    place = folder() / "foam-input/constant/polyMesh"
    place.mkdir(parents=True, exist_ok=True)
    hit = draw.draw(st.sampled_from(sorted(files)))
    for name, content in files.items():
        (place / name).write_bytes(damaged(draw, content) if name == hit else content)
    with refused_or_read():
        judge(read_mesh(folder() / "foam-input"))


def run_folder(draw: st.DataObject) -> None:
    """Open a run whose case.json a stranger wrote."""
    place = folder() / "run"
    place.mkdir(exist_ok=True)
    path = folder() / "whole.toml"
    path.write_bytes(seeds()["first-layered.toml"])
    whole = json.dumps(read_case(path).model_dump(mode="json")).encode()
    (place / "case.json").write_bytes(damaged(draw, whole))
    with refused_or_read():
        Run.opened(place)


TARGETS: dict[str, Callable[[st.DataObject], None]] = {
    "text with a unit": units,
    "case file, damaged": damaged_case,
    "study file, damaged": damaged_study,
    "case file, odd values": odd_values,
    "--set": overrides,
    "options of predict": options,
    "fibers as CSV": fibers,
    "mesh file (Fluent, gmsh, VTU, Abaqus, Nastran, SU2, Medit)": mesh_file,
    "mesh in a random dialect of eight formats, damaged": damaged_dialect,
    "OpenFOAM mesh, text and binary": openfoam_mesh,
    "folder of a run": run_folder,
}
