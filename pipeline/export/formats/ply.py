"""PLY: the fibers' surface in triangles, each with the number of its fiber."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.cad.surfaces import write_ply
from pipeline.export.formats.format import Format, Order
from pipeline.nouns.surface import Surface


def _write(surface: Surface, folder: Path, order: Order) -> None:
    order.progress("export: ply")
    write_ply(surface, folder / "surface.ply", order.settings.length_unit)


FORMAT = Format("ply", (".ply",), Surface, cells="none", patches="lost", write=_write)
