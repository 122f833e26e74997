"""What a file format is to fibertwin: its name and suffixes, what it can hold, and how it is written and read."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pipeline.nouns.arrays import Floats
from pipeline.nouns.flow import Flow
from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import Progress, silent

if TYPE_CHECKING:
    from pipeline.export.formats.openfoam.slip import FiberSlip
    from pipeline.export.settings import ExportSettings

HEAD = 4096
"""Bytes at a file's start by which formats of the same suffix are told apart."""


@dataclass(frozen=True, slots=True)
class Order:
    """What a format may need beside the mesh.

    Parameters
    ----------
    settings : ExportSettings
    flow : Flow
    sides : "symmetry", "slip" or "cyclic"
        What the duct's sides are to a solver.
    fields : mapping of name to (cells,) array
        Shown on the cells by a format that can.
    slip : FiberSlip, optional
        How far the air slips along the fibers; it stands still on them without.
    progress : Progress
    mesher : str, optional
        As ``tetmesh.engine`` names it, and
    edge : float [-], optional
        its edge at the fibers in fiber diameters, and
    growth : float [-]
        how much longer edges become per distance from them, for what is known of the mesh's error.
    """

    settings: "ExportSettings"
    flow: Flow
    sides: str
    fields: Mapping[str, Floats] = field(default_factory=dict)
    slip: "FiberSlip | None" = None
    progress: Progress = silent
    mesher: str | None = None
    edge: float | None = None
    growth: float = 1.0


@dataclass(frozen=True, slots=True)
class Format:
    """A file format, whole: its file in this folder makes one, and `registry` lists it.

    Parameters
    ----------
    name : str
        In `export.formats` and after ``--format``.
    suffixes : tuple of str
        Lower-case, with their dot; a file's suffix counts in any case.
    of : type
        The noun that it holds: the mesh, the fibers' surface, or the mat.
    cells : "any", "tetrahedra" or "none"
        What it can hold of a volume; none for a surface or center lines.
    patches : "by name", "by number" or "lost"
    write : function of what it holds, a folder and an `Order`, optional
        Puts its files into the folder, which is there and empty. It raises a `StageError` where it cannot.
    read : function of a path, optional
        Gives the mesh; it raises a `StageError` where the file holds none.
    recognizes : function of a file's first `HEAD` bytes
        Whether a file of one of the suffixes is of this format, where formats share a suffix.
    unavailable_because : str, optional
        Why the format is neither written nor read, and what to take instead.
    """

    name: str
    suffixes: tuple[str, ...] = ()
    of: type = FaceMesh
    cells: Literal["any", "tetrahedra", "none"] = "any"
    patches: Literal["by name", "by number", "lost"] = "by name"
    write: Callable[[Any, Path, Order], None] | None = None
    read: Callable[[Path], FaceMesh] | None = None
    recognizes: Callable[[bytes], bool] = lambda head: True
    unavailable_because: str | None = None
