"""A complete case of OpenFOAM: the mesh, the fields at the start, the solver's dictionaries, and scripts."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.export.formats.format import Format, Order
from pipeline.nouns.mesh import FaceMesh


def _write(mesh: FaceMesh, folder: Path, order: Order) -> None:
    from pipeline.export.formats.openfoam.case import write_openfoam
    from pipeline.export.formats.openfoam.readme import format_readme

    write_openfoam(mesh, folder, order.flow, order.sides, order.settings, order.progress, order.slip)
    text = format_readme(order.flow.density, order.slip is not None, order.mesher, order.edge, order.growth)
    (folder / "README.md").write_text(text, encoding="ascii")


# a case is a folder: `pipeline.export.read` finds it by its mesh, not by a suffix
FORMAT = Format("openfoam", write=_write)
