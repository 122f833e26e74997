"""STL, for drawing programs and printers: the fibers' surface in triangles, without their numbers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.cad.surfaces import write_stl
from pipeline.export.formats.format import Format, Order
from pipeline.nouns.surface import Surface


def _write(surface: Surface, folder: Path, order: Order) -> None:
    order.progress("export: stl")
    write_stl(surface, folder / "surface.stl", order.settings.length_unit)


FORMAT = Format("stl", (".stl",), Surface, cells="none", patches="lost", write=_write)
