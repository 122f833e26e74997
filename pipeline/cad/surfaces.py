"""The united fibers as STL, PLY and OBJ, in a unit that suits the absolute tolerance of drawing programs."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import Literal

import numpy as np

from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.surface import Surface

LengthUnit = Literal["um", "mm", "m"]
PER_METER: dict[LengthUnit, float] = {"um": 1e6, "mm": 1e3, "m": 1.0}
WORDS: dict[LengthUnit, str] = {"um": "micrometers", "mm": "millimeters", "m": "meters"}
_MANTISSA = 23  # bits of a number of 32 bits behind the point
_STL_HEADER = 80  # bytes
_PLY_HEADER = """\
ply
format binary_little_endian 1.0
comment the outside of all fibers, in {unit}
element vertex {points}
property double x
property double y
property double z
element face {triangles}
property list uchar int vertex_indices
property int fiber
end_header
"""


def write_stl(surface: Surface, path: Path, unit: LengthUnit = "um") -> None:
    """Write binary STL, whose header says the unit; it has no fiber numbers, as that format is.

    Its numbers have 32 bits. Points stand on a grid of that precision, those that fall together are one, so that every
    reader finds each edge twice whether it joins points that are equal or those within 1e-8 of the whole.
    """
    points, triangles = on_grid(surface.points * PER_METER[unit], surface.triangles)
    path.write_bytes(stl_bytes(points, triangles, f"fibers, in {WORDS[unit]}"))


def stl_bytes(points: Floats, triangles: Ints, about: str) -> bytes:
    """Give a binary STL file.

    Parameters
    ----------
    points : (n, 3) array
    triangles : (m, 3) int array
    about : str
        At most 80 ASCII letters.
    """
    faces = np.zeros(len(triangles), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]))
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces["normal"] = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    faces["corners"] = corners
    # a header that begins with "solid" would look like text
    return about.encode("ascii").ljust(_STL_HEADER)[:_STL_HEADER] + len(faces).to_bytes(4, "little") + faces.tobytes()


def on_grid(points: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Round points to a grid that 32 bits hold exactly, join those that fall together, and drop what becomes flat.

    Parameters
    ----------
    points : (n, 3) array
    triangles : (m, 3) int array
        Closed.

    Returns
    -------
    points, triangles
        Closed; points differ by 1e-7 of the largest coordinate or more.
    """
    spacing = 2.0 ** (np.ceil(np.log2(np.abs(points).max(initial=1e-300))) - _MANTISSA)
    steps, same = np.unique(np.round(points / spacing).astype(np.int64), axis=0, return_inverse=True)
    moved = same.reshape(-1)[triangles]
    flat = (moved == np.roll(moved, 1, axis=1)).any(axis=1)
    moved = moved[~flat]
    # two triangles that became one, back to back, enclose nothing
    order = np.argsort(moved, axis=1)
    turned = ((order[:, 1] - order[:, 0]) % 3 == 2).astype(np.int64)
    _, group = np.unique(np.sort(moved, axis=1), axis=0, return_inverse=True)
    balance = np.bincount(group.reshape(-1), 1.0 - 2.0 * turned)
    paired = np.bincount(group.reshape(-1)) > 1
    kept = ~(paired & (balance == 0))[group.reshape(-1)]
    return steps * spacing, moved[kept]


def write_ply(surface: Surface, path: Path, unit: LengthUnit = "um") -> None:
    """Write binary PLY with coordinates of 64 bits and each triangle's property ``fiber``; a comment says the unit.

    trimesh writes PLY coordinates with 32 bits and meshio without the triangles' properties, hence our own.
    """
    faces = np.empty(len(surface.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3), ("fiber", "<i4")])
    faces["count"], faces["corners"], faces["fiber"] = 3, surface.triangles, surface.fiber
    header = _PLY_HEADER.format(unit=WORDS[unit], points=len(surface.points), triangles=len(surface.triangles))
    points = (surface.points * PER_METER[unit]).astype("<f8")
    path.write_bytes(header.encode("ascii") + points.tobytes() + faces.tobytes())


def write_obj(surface: Surface, path: Path, unit: LengthUnit = "um") -> None:
    """Write OBJ with a group per fiber; a comment says the unit."""
    order = np.argsort(surface.fiber, kind="stable")
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"# the outside of all fibers, in {WORDS[unit]}\n")
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in (surface.points * PER_METER[unit]).tolist())
        of, before = surface.fiber[order].tolist(), -1
        for fiber, (a, b, c) in zip(of, (surface.triangles[order] + 1).tolist(), strict=True):
            if fiber != before:
                file.write(f"g fiber_{fiber}\n")
                before = fiber
            file.write(f"f {a} {b} {c}\n")
