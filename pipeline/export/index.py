"""The index of the exported VTK files names the flow, once there is one of this mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from pipeline.export.formats.vtk_index import BOUNDARY, INDEX, format_vtm
from pipeline.line.places import write_text
from pipeline.line.stage import giver
from pipeline.nouns.flow_field import FLOW_FILE, FlowField
from pipeline.reading import read_bytes

if TYPE_CHECKING:
    from pipeline.line.results import Results

_LARGEST = 10_000_000  # bytes of an index


def name_flow(results: "Results") -> None:
    """Write the index anew where it does not name just what there is.

    Parameters
    ----------
    results : Results
        Of the run, without those that are of another case.
    """
    made = results.manifest("export")
    folder = results.folder / "export" / "vtk"
    patches = [
        PurePosixPath(name).stem
        for name in (made or {"files": {}})["files"]
        if PurePosixPath(name).parent == PurePosixPath("vtk") / BOUNDARY
    ]
    if not patches or folder.is_symlink():
        return
    text = format_vtm(patches, _flow(results, folder))
    if _read(folder / INDEX) != text:
        write_text(folder / INDEX, text)


def _flow(results: "Results", folder: Path) -> str | None:
    stage = giver(results.line, FlowField).name
    path = results.folder / stage / FLOW_FILE
    made = None if stage in results.left_out else results.manifest(stage)
    if made is None or FLOW_FILE not in made["files"] or not path.is_file():
        return None
    return PurePosixPath(os.path.relpath(path, folder)).as_posix()


def _read(path: Path) -> str | None:
    try:
        return read_bytes(path, _LARGEST, links=False).decode()
    except (OSError, UnicodeDecodeError):
        return None
