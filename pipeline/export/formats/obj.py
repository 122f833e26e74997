"""OBJ: the fibers' surface in triangles, a group per fiber."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.cad.surfaces import write_obj
from pipeline.export.formats.format import Format, Order
from pipeline.nouns.surface import Surface


def _write(surface: Surface, folder: Path, order: Order) -> None:
    order.progress("export: obj")
    write_obj(surface, folder / "surface.obj", order.settings.length_unit)


FORMAT = Format("obj", (".obj",), Surface, cells="none", patches="lost", write=_write)
