"""Writes random valid meshes in every dialect that a reader meets: what other programs and people make of a format.

`draw` makes a mesh of a random block of cells and writes it in a random dialect of a format; what a reader has to find
is known from how it was made.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.export.formats.file_mesh import Cells, FileMesh, NamedFaces, face_mesh
from pipeline.export.formats.format import Order
from pipeline.export.settings import ExportSettings
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh
from pipeline.openfoam.foam_file import Encoding
from tests.openfoam import AIR
from validation.closed_flows import brick_tets

Random = np.random.Generator
ORDER = Order(ExportSettings(), AIR, "symmetry")


@dataclass(frozen=True)
class Block:
    """A box of cells: hexahedra, or the six tetrahedra or two prisms in each; its inlet is at z = 0."""

    points: Floats
    kind: str
    cells: Ints
    inlet: Ints
    outlet: Ints
    volume: float

    def mesh(self) -> FaceMesh:
        surfaces = [NamedFaces(self.inlet, "inlet"), NamedFaces(self.outlet, "outlet")]
        return face_mesh(FileMesh(self.points, [Cells(self.kind, self.cells)], surfaces))

    @property
    def patches(self) -> dict[str, int]:
        mesh = self.mesh()
        return {patch.name: patch.count for patch in mesh.patches}


def block(draw: Random, kinds: tuple[str, ...] = ("tetra", "wedge", "hexahedron")) -> Block:
    """Draw one: its size, its unit of length, its kind of cell, and inner points that are moved a little."""
    shape = draw.integers(2, 4, 3)
    kind = str(draw.choice(kinds))
    size = draw.uniform(0.5, 2.0, 3) * 10.0 ** draw.integers(-6, 2)
    axes = [np.linspace(0, length, n + 1) for length, n in zip(size, shape, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(shape + 1)
    low = (slice(None, -1), slice(1, None))

    def corner(i: int, j: int, k: int) -> Ints:
        return number[low[i], low[j], low[k]].ravel()

    base = [(0, 0), (1, 0), (1, 1), (0, 1)]
    hexahedra = np.column_stack([corner(i, j, k) for k in (0, 1) for i, j in base])
    if kind == "tetra":
        cells = brick_tets((int(shape[0]), int(shape[1]), int(shape[2])))
        faces = cells[:, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]].reshape(-1, 3)
    elif kind == "wedge":
        cells = np.concatenate([hexahedra[:, [0, 1, 2, 4, 5, 6]], hexahedra[:, [0, 2, 3, 4, 6, 7]]])
        faces = np.concatenate([cells[:, [0, 2, 1]], cells[:, [3, 4, 5]]])
    else:
        cells = hexahedra
        faces = np.concatenate([cells[:, [0, 3, 2, 1]], cells[:, [4, 5, 6, 7]]])
    ends = [faces[(points[faces][:, :, 2] == level).all(axis=1)] for level in (0.0, size[2])]
    inner = np.zeros(shape + 1, bool)
    inner[1:-1, 1:-1, 1:-1] = True
    # a fifth of a spacing turns no cell inside out and keeps quadrangles sound
    points[inner.ravel()] += draw.uniform(-0.2, 0.2, (int(inner.sum()), 3)) * size / shape
    return Block(points, kind, cells, ends[0], ends[1], float(np.prod(size)))


def shuffled(draw: Random, one: Block) -> tuple[Block, Ints]:
    """Give the block with its points in another order, and the number of each: neither dense nor sorted."""
    order = draw.permutation(len(one.points))
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    numbers = draw.choice(np.arange(1, 9 * len(order)), len(order), replace=False)
    return (
        Block(one.points[order], one.kind, place[one.cells], place[one.inlet], place[one.outlet], one.volume),
        numbers.astype(np.int64),
    )


def any_case(draw: Random, text: str) -> str:
    return str(draw.choice([text, text.lower(), text.upper(), text.title()]))


def abaqus(draw: Random, folder: Path) -> tuple[Path, Block]:
    """Several node blocks, sets before or after, by list, range or set, shells or sides, a part and its instance."""
    one, numbers = shuffled(draw, block(draw))
    types = {"tetra": ("C3D4", "C3D4H", "DC3D4"), "wedge": ("C3D6",), "hexahedron": ("C3D8", "C3D8R", "AC3D8")}
    cut = int(draw.integers(1, len(numbers)))
    comma = str(draw.choice(["", ","]))
    nodes = [f"{n}, {x!r}, {y!r}, {z!r}{comma}" for n, (x, y, z) in zip(numbers, one.points.tolist(), strict=True)]
    lines = ["*HEADING", "drawn", "** a comment"]
    in_part = bool(draw.integers(0, 2))
    if in_part:
        lines.append(any_case(draw, "*PART, NAME=A"))
    lines += [any_case(draw, "*NODE"), *nodes[:cut], any_case(draw, "*NODE, NSET=rest"), *nodes[cut:]]
    if in_part and draw.integers(0, 2):
        lines[-1:] = [nodes[-1]]
    kind = str(draw.choice(types[one.kind]))
    lines += [any_case(draw, f"*ELEMENT, TYPE={kind}"), *_rows(numbers, one.cells, 1)]
    first = 1 + len(one.cells) + int(draw.integers(0, 1000))
    for name, faces in (("inlet", one.inlet), ("outlet", one.outlet)):
        shell = f"S{faces.shape[1]}"
        how = draw.integers(0, 3)
        if how == 0:
            lines += [f"*ELEMENT, TYPE={shell}, ELSET={name}", *_rows(numbers, faces, first)]
        else:
            members = (
                [f"{first}, {first + len(faces) - 1}, 1"]
                if how == 1
                else [f"{k}," for k in range(first, first + len(faces))]
            )
            group = [f"*ELSET, ELSET={name}{', GENERATE' if how == 1 else ''}", *members]
            elements = [f"*ELEMENT, TYPE={shell}", *_rows(numbers, faces, first)]
            lines += [*group, *elements] if draw.integers(0, 2) else [*elements, *group]
        first += len(faces)
    lines += ["*ELSET, ELSET=both", "inlet, outlet"]
    if in_part:
        lines += ["*END PART", "*PART, NAME=RP", "*NODE", "1, 0., 0., 0.", "*END PART"]
        if draw.integers(0, 2):
            lines += [
                "*ASSEMBLY, NAME=all",
                "*INSTANCE, NAME=A-1, PART=a",
                "1., 2., 3.",
                "*END INSTANCE",
                "*END ASSEMBLY",
            ]
    return _text(draw, folder / f"it.{any_case(draw, 'inp')}", lines), one


def _rows(numbers: Ints, cells: Ints, first: int) -> list[str]:
    return [", ".join(map(str, [first + k, *numbers[row].tolist()])) for k, row in enumerate(cells)]


def nastran(draw: Random, folder: Path) -> tuple[Path, Block]:
    """Free, small, tabbed or large fields, continuations of every kind, a rotated or cylindrical system."""
    one, numbers = shuffled(draw, block(draw))
    style = str(draw.choice(["free", "small", "tabs", "large"]))
    system = int(draw.choice([0, 7])) if style in ("free", "large") else 0
    points = one.points
    lines = ["SOL 101", "CEND", "BEGIN BULK"] if draw.integers(0, 2) else []
    if system:
        # about an axis along y, turned and moved
        lines.append("CORD2C,7,0,1.,2.,3.,1.,3.,3.,+\n+,1.,2.,4.")
        points = np.column_stack(
            [np.hypot(points[:, 0], points[:, 1]), np.degrees(np.arctan2(points[:, 1], points[:, 0])), points[:, 2]]
        )
    for n, p in zip(numbers.tolist(), points.tolist(), strict=True):
        lines.append(_grid(style, n, system, p))
    cards = {"tetra": "CTETRA", "wedge": "CPENTA", "hexahedron": "CHEXA"}
    first = 1
    for group, cells in ((1, one.cells), (2, one.inlet), (3, one.outlet)):
        card = cards[one.kind] if group == 1 else {3: "CTRIA3", 4: "CQUAD4"}[cells.shape[1]]
        for k, row in enumerate(numbers[cells].tolist()):
            lines += _card(style, card, [first + k, group, *row])
        first += len(cells)
    names = draw.integers(0, 2)
    if names:
        lines[:0] = ['$HMNAME COMP                   2"inlet"', "$ANSA_NAME_COMMENT;3;PSHELL;outlet;"]
    lines.append("ENDDATA")
    if style == "small" and draw.integers(0, 2):
        lines = [line if line.startswith("$") else line.lower() for line in lines]
    path = _text(draw, folder / f"it.{any_case(draw, 'bdf')}", lines)
    return path, one if names else _renamed(one)


class _Numbered(Block):
    @property
    def patches(self) -> dict[str, int]:
        return {{"inlet": "surface-2", "outlet": "surface-3"}.get(name, name): n for name, n in super().patches.items()}


def _renamed(one: Block) -> Block:
    return _Numbered(one.points, one.kind, one.cells, one.inlet, one.outlet, one.volume)


def _grid(style: str, number: int, system: int, place: list[float]) -> str:
    if style == "free":
        return ",".join(["GRID", str(number), str(system or ""), *(f"{x:.12E}" for x in place)])
    if style == "large":
        from pipeline.export.formats.nastran import large_field

        x, y, z = map(large_field, place)
        return f"GRID*   {number:>16}{system or '':>16}{x}{y}*A\n*A      {z}"
    words = [_short(x) for x in place]
    if style == "tabs":
        return "\t".join(["GRID", str(number), "", *words])
    return f"GRID    {number:>8}{'':8}" + "".join(f"{word:>8}" for word in words)


def _short(value: float) -> str:
    """A number in eight characters, with the exponent that needs no letter."""
    if value == 0:
        return "0."
    mantissa, exponent = f"{value:.3e}".split("e")
    return f"{mantissa}{int(exponent):+d}"


def _card(style: str, card: str, words: list[int]) -> list[str]:
    if style == "free":
        return [",".join(map(str, [card, *words[:8]])), *(["," + ",".join(map(str, words[8:]))] if words[8:] else [])]
    if style == "tabs":
        return [
            "\t".join(map(str, [card, *words[:8]])),
            *(["\t" + "\t".join(map(str, words[8:]))] if words[8:] else []),
        ]
    head = f"{card:<8}" + "".join(f"{word:>8}" for word in words[:8])
    return [
        head + ("+" if words[8:] else ""),
        *([f"{'+':<8}" + "".join(f"{w:>8}" for w in words[8:])] if words[8:] else []),
    ]


def gmsh(draw: Random, folder: Path) -> tuple[Path, Block]:
    """Versions 2.2, 4.0 and 4.1 in text and binary by meshio, or 2.2 with elements in two groups by hand."""
    import meshio

    one = block(draw)
    version = str(draw.choice(["2.2", "4.0", "4.1"]))
    name = {"tetra": "tetra", "wedge": "wedge", "hexahedron": "hexahedron"}[one.kind]
    flat = {3: "triangle", 4: "quad"}[one.inlet.shape[1]]
    blocks = [(name, one.cells), (flat, one.inlet), (flat, one.outlet)]
    tags = [np.full(len(cells), tag) for tag, (_, cells) in enumerate(blocks, 1)]
    path = folder / f"it.{any_case(draw, 'msh')}"
    if version == "2.2" and draw.integers(0, 2):
        # each face stands in a group of its own, and again in one of both
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "3", '2 2 "in let"', '2 3 "outlet"']
        lines += ['3 1 "air"', "$EndPhysicalNames", "$Nodes", str(len(one.points))]
        lines += [f"{k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(one.points.tolist(), 1)]
        code = {"tetra": 4, "hexahedron": 5, "wedge": 6, "triangle": 2, "quad": 3}
        parts = [*zip((1, 2, 3), blocks, strict=True), (9, blocks[1]), (9, blocks[2]), (8, blocks[0])]
        rows = [
            f"{code[kind]} 2 {tag} {tag} " + " ".join(map(str, row + 1))
            for tag, (kind, cells) in parts
            for row in cells
        ]
        draw.shuffle(rows)
        lines += [
            "$EndNodes",
            "$Elements",
            str(len(rows)),
            *(f"{k} {row}" for k, row in enumerate(rows, 1)),
            "$EndElements",
        ]
        return _text(draw, path, lines), one
    # the entity of each point: without it meshio writes no entities, and so no names
    entity = np.tile([3, 1], (len(one.points), 1))
    for tag, faces in ((2, one.inlet), (3, one.outlet)):
        entity[np.unique(faces)] = (2, tag)
    whole = meshio.Mesh(
        one.points,
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"air": np.array([1, 3]), "inlet": np.array([2, 2]), "outlet": np.array([3, 2])},
        point_data={"gmsh:dim_tags": entity} if version == "4.1" else None,
    )
    meshio.gmsh.write(path, whole, version, binary=bool(draw.integers(0, 2)))
    return path, _unnamed(one) if version == "4.0" else one


class _Unnamed(Block):
    @property
    def patches(self) -> dict[str, int]:
        return {"boundary": sum(super().patches.values())}


def _unnamed(one: Block) -> Block:
    return _Unnamed(one.points, one.kind, one.cells, one.inlet, one.outlet, one.volume)


def vtk(draw: Random, folder: Path) -> tuple[Path, Block]:
    """By VTK's writers: XML and legacy, every encoding, byte order and compressor; polyhedra; grids without cells."""
    import pyvista as pv
    from vtkmodules.vtkIOLegacy import vtkUnstructuredGridWriter
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    from pipeline.export.formats.vtk import volume_grid

    one = block(draw)
    how = str(draw.choice(["xml", "legacy", "polyhedra", "rectilinear", "structured"]))
    kinds = {"tetra": pv.CellType.TETRA, "wedge": pv.CellType.WEDGE, "hexahedron": pv.CellType.HEXAHEDRON}
    if how in ("rectilinear", "structured"):
        return _grid_file(draw, folder, how)
    # a mesh of tetrahedra only is written as such
    polyhedral = how == "polyhedra" and one.kind != "tetra"
    grid = volume_grid(one.mesh()) if polyhedral else pv.UnstructuredGrid({kinds[one.kind]: one.cells}, one.points)
    if how == "legacy":
        path, writer = folder / f"it.{any_case(draw, 'vtk')}", vtkUnstructuredGridWriter()
        writer.SetFileVersion(int(draw.choice([42, 51])))
        writer.SetFileType(int(draw.choice([1, 2])))
    else:
        path, writer = folder / f"it.{any_case(draw, 'vtu')}", vtkXMLUnstructuredGridWriter()
        writer.SetDataMode(int(draw.integers(0, 3)))
        writer.SetCompressorType(int(draw.integers(0, 4)))
        writer.SetByteOrder(int(draw.integers(0, 2)))
        writer.SetHeaderType(int(draw.choice([32, 64])))
        writer.SetEncodeAppendedData(bool(draw.integers(0, 2)))
        writer.SetBlockSize(int(draw.choice([64, 32768])))
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    assert writer.Write() == 1
    return path, _unnamed(one)


def _grid_file(draw: Random, folder: Path, how: str) -> tuple[Path, Block]:
    import pyvista as pv

    shape, size = draw.integers(2, 4, 3), draw.uniform(0.5, 2.0, 3)
    axes = [np.linspace(0, length, n + 1) for length, n in zip(size, shape, strict=True)]
    grid = pv.RectilinearGrid(*axes)
    suffix = str(draw.choice(["vtr", "vtk"]))
    if how == "structured":
        grid, suffix = grid.cast_to_structured_grid(), str(draw.choice(["vts", "vtk"]))
    path = folder / f"it.{suffix}"
    grid.save(path, binary=bool(draw.integers(0, 2)))
    cells = np.zeros((int(np.prod(shape)), 8), np.int64)
    faces = 2 * int(shape[0] * shape[1] + shape[1] * shape[2] + shape[0] * shape[2])
    return path, _Grid(
        np.empty((0, 3)), "hexahedron", cells, np.empty(faces, np.int64), np.empty(0, np.int64), float(np.prod(size))
    )


class _Grid(Block):
    @property
    def patches(self) -> dict[str, int]:
        return {"boundary": len(self.inlet)}


def fluent(draw: Random, folder: Path) -> tuple[Path, Block]:
    """Comments with sections in them, zones of nodes in any order, inner faces in zones of any two-sided kind."""
    one = block(draw)
    mesh = one.mesh()
    lines = ['(0 "a ) comment")', "(0 nodes: (10 (id start end type) (x y z ...)))", "(2 3)"]
    if draw.integers(0, 2):
        lines.append("(4 (60 0 0 1 2 4 4 4 8 4 8 4))")
    n = len(mesh.points)
    lines.append(f"(10 (0 1 {n:x} 0 3))")
    cut = int(draw.integers(1, n))
    zones = [(1, 0, cut), (2, cut, n)]
    for zone, start, end in zones[:: int(draw.choice([1, -1]))]:
        rows = "\n".join(" ".join(map(repr, p)) for p in mesh.points[start:end].tolist())
        lines.append(f"(10 ({zone:x} {start + 1:x} {end:x} 1 3)\n(\n{rows}\n))")
    lines.append(f"(12 (0 1 {mesh.cells:x} 0))\n(12 (20 1 {mesh.cells:x} 1 {7:x}))\n(13 (0 1 {mesh.faces:x} 0))")
    inner = int(draw.integers(1, mesh.internal))
    kinds = [("interior", 2), ("fan", 14), ("porous-jump", 14), ("interface", 24), ("radiator", 14)]
    word, code = kinds[int(draw.integers(0, len(kinds)))]
    runs = [("interior-1", "interior", 2, 0, inner), ("between", word, code, inner, mesh.internal)]
    runs += [(p.name, "wall", 3, p.start, p.start + p.count) for p in mesh.patches]
    for zone, (_, _, code, start, end) in enumerate(runs, 0x21):
        listed = []
        for face in range(start, end):
            corners = mesh.corners[mesh.offsets[face] : mesh.offsets[face + 1]][::-1] + 1
            other = int(mesh.neighbour[face]) + 1 if face < mesh.internal else 0
            listed.append(" ".join(f"{k:x}" for k in [len(corners), *corners, int(mesh.owner[face]) + 1, other]))
        lines.append(
            f"(13 ({zone:x} {start + 1:x} {end:x} {code:x} {draw.choice([0, 5])})(\n" + "\n".join(listed) + "\n))"
        )
    lines += [f"({draw.choice([39, 45])} ({zone} {kind} {name})())" for zone, (name, kind, *_) in enumerate(runs, 0x21)]
    return _text(draw, folder / f"it.{any_case(draw, 'msh')}", lines), one


def su2(draw: Random, folder: Path) -> tuple[Path, Block]:
    """Markers before or after, with and without numbers behind the rows, comments, blanks around the equals sign."""
    one = block(draw)
    code = {"tetra": 10, "hexahedron": 12, "wedge": 13}[one.kind]
    equals = str(draw.choice(["=", "= ", " = "]))
    numbered = bool(draw.integers(0, 2))

    def rows(kind: int, cells: Ints) -> list[str]:
        return [" ".join(map(str, [kind, *row, *([k] if numbered else [])])) for k, row in enumerate(cells.tolist())]

    points = [" ".join(map(repr, p)) + (f" {k}" if numbered else "") for k, p in enumerate(one.points.tolist())]
    parts = [[f"NELEM{equals}{len(one.cells)}", *rows(code, one.cells)], [f"NPOIN{equals}{len(points)}", *points]]
    flat = {3: 5, 4: 9}[one.inlet.shape[1]]
    markers = [f"NMARK{equals}2"]
    for name, faces in (("inlet", one.inlet), ("outlet", one.outlet)):
        markers += [f"MARKER_TAG{equals}{name}", f"MARKER_ELEMS{equals}{len(faces)}", *rows(flat, faces)]
    parts.append(markers)
    order = draw.permutation(3)
    lines = ["% drawn", f"NDIME{equals}3", *(line for k in order for line in parts[k])]
    return _text(draw, folder / f"it.{any_case(draw, 'su2')}", lines), one


def medit(draw: Random, folder: Path) -> tuple[Path, Block]:
    """Sections in any order, with comments and words on the same or on the next line."""
    one = block(draw)
    title = {"tetra": "Tetrahedra", "wedge": "Prisms", "hexahedron": "Hexahedra"}[one.kind]
    flat = {3: "Triangles", 4: "Quadrilaterals"}[one.inlet.shape[1]]
    points = [" ".join(map(repr, p)) + " 0" for p in one.points.tolist()]
    cells = [" ".join(map(str, [*row, 1])) for row in (one.cells + 1).tolist()]
    faces = [
        " ".join(map(str, [*row, tag]))
        for tag, part in ((2, one.inlet), (3, one.outlet))
        for row in (part + 1).tolist()
    ]
    between = str(draw.choice([" ", "\n"]))
    parts = [
        [f"{name}{between}{len(rows)}", *rows] for name, rows in (("Vertices", points), (title, cells), (flat, faces))
    ]
    lines = [f"MeshVersionFormatted{between}2", "# drawn", f"Dimension{between}3"]
    lines += [line for k in draw.permutation(3) for line in parts[k]]
    return _text(draw, folder / f"it.{any_case(draw, 'mesh')}", [*lines, "End"]), _renamed(one)


def openfoam(draw: Random, folder: Path) -> tuple[Path, Block]:
    """Text and binary, a later time, dictionaries in dictionaries, patches of no face, lists of equal values."""
    from pipeline.export.formats.openfoam.poly_mesh import write_poly_mesh

    one = block(draw)
    mesh = one.mesh()
    times = ["constant", *(["0.5", "2", "10"] if draw.integers(0, 2) else [])]
    for time in times:
        place = folder / time / "polyMesh"
        place.mkdir(parents=True)
        shown = mesh if time == times[-1] else block(draw).mesh()
        encoding: Encoding = "ascii" if draw.integers(0, 2) else "binary"
        write_poly_mesh(shown, place, {p.name: "type wall;" for p in shown.patches}, encoding)
    place = folder / times[-1] / "polyMesh"
    boundary = (place / "boundary").read_text()
    boundary = boundary.replace("type wall;", "type mappedPatch; offset (0 0 1); extra { a { b 1; } nFaces 77; }", 1)
    empty = f"    nothing {{ type wall; nFaces 0; startFace {mesh.internal}; }}\n"
    at = boundary.index("\n(\n") + 3
    (place / "boundary").write_text(boundary[:at] + empty + boundary[at:])
    return folder, _WithNothing(one.points, one.kind, one.cells, one.inlet, one.outlet, one.volume)


class _WithNothing(Block):
    @property
    def patches(self) -> dict[str, int]:
        return {"nothing": 0, **super().patches}


def _text(draw: Random, path: Path, lines: list[str]) -> Path:
    end = str(draw.choice(["\n", "\r\n"]))
    path.write_bytes((end.join(end.join(lines).splitlines()) + end).encode("latin-1"))
    return path


DIALECTS: dict[str, Callable[[Random, Path], tuple[Path, Block]]] = {
    "Abaqus": abaqus, "NASTRAN": nastran, "gmsh": gmsh, "VTK": vtk, "Fluent": fluent, "SU2": su2, "Medit": medit,
    "OpenFOAM": openfoam,
}  # fmt: skip
