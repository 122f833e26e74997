"""The paper's list of cylinders, from which SpaceClaim's scripts build the fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.cad.fibers import write_spaceclaim
from pipeline.export.formats.format import Format, Order
from pipeline.nouns.fibers import Mat


def _write(mat: Mat, folder: Path, order: Order) -> None:
    order.progress("export: spaceclaim")
    write_spaceclaim(mat, folder / "cylinders.txt")


FORMAT = Format("spaceclaim", of=Mat, cells="none", patches="lost", write=_write)
