"""The united fibers in files that other programs read."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np

from pipeline.nouns.surface import Surface

_PLY_HEADER = """\
ply
format binary_little_endian 1.0
comment the outside of all fibers, in meters
element vertex {points}
property double x
property double y
property double z
element face {triangles}
property list uchar int vertex_indices
property int fiber
end_header
"""


def write_surface(surface: Surface, folder: Path) -> list[Path]:
    """Write the surface as ``surface.stl`` and ``surface.ply``, in meters.

    Parameters
    ----------
    surface : Surface
    folder : Path
        Made where it does not exist.

    Returns
    -------
    list of Path
        The binary STL (32-bit numbers and no fiber ids, as that format is) and the binary PLY, with 64-bit
        coordinates and each triangle's property ``fiber``.
    """
    import trimesh

    folder.mkdir(parents=True, exist_ok=True)
    stl, ply = folder / "surface.stl", folder / "surface.ply"
    stl.write_bytes(trimesh.Trimesh(surface.points, surface.triangles, process=False).export(file_type="stl"))
    ply.write_bytes(ply_bytes(surface))
    return [stl, ply]


def ply_bytes(surface: Surface) -> bytes:
    """Give the surface as a binary PLY file.

    trimesh writes PLY coordinates with 32 bits and meshio without the triangles' properties, hence our own.

    Parameters
    ----------
    surface : Surface

    Returns
    -------
    bytes
    """
    faces = np.empty(len(surface.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3), ("fiber", "<i4")])
    faces["count"], faces["corners"], faces["fiber"] = 3, surface.triangles, surface.fiber
    header = _PLY_HEADER.format(points=len(surface.points), triangles=len(surface.triangles))
    return header.encode("ascii") + surface.points.astype("<f8").tobytes() + faces.tobytes()
