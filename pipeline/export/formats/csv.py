"""CSV of the fibers' center lines, which `mat.file` reads back."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.cad.fibers import write_fibers
from pipeline.export.formats.format import Format, Order
from pipeline.nouns.fibers import Mat


def _write(mat: Mat, folder: Path, order: Order) -> None:
    order.progress("export: csv")
    write_fibers(mat, folder / "fibers.csv")


FORMAT = Format("csv", of=Mat, cells="none", patches="lost", write=_write)
