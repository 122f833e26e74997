"""`fibertwin tiles`: a mesh that no memory holds whole, as a case that is decomposed already."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import re
import sys
from pathlib import Path

from rich.console import Console

from pipeline.case import read_case
from pipeline.cli.listen import listening
from pipeline.cli.tables import plain_table
from pipeline.errors import CaseError
from pipeline.nouns.tiled import TiledMesh

_COUNTS = re.compile(r"([1-9]\d{0,3})x([1-9]\d{0,3})")
_COLUMNS = (
    "tile", "cells", "shared faces", "angle max [deg]", "skewness", "walls off mean / 99 % [d]", "verdict", "cpu",
    "memory",
)  # fmt: skip


def tile_case(
    path: Path,
    folder: Path,
    counts: str,
    workers: int | None,
    scheduler: str | None,
    overrides: tuple[str, ...],
    as_json: bool,
    quiet: bool,
) -> None:
    """Mesh a case in tiles, and print what each is like."""
    found = _COUNTS.fullmatch(counts)
    if found is None:
        raise CaseError(f"--tiles {counts}: as many as along x and y, like 2x2")
    if workers is not None and workers < 1:
        raise CaseError(f"--workers {workers}: one or more")
    case = read_case(path, overrides)
    out = Console()
    with listening(Console(stderr=True) if as_json else out, quiet) as progress:
        from pipeline.tiles.make import FOLDER, tiled
        from pipeline.tiles.work import CASE

        result = tiled(case, folder, (int(found[1]), int(found[2])), workers, scheduler, progress)
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(result), indent=2, allow_nan=False) + "\n")
    elif not quiet:
        out.print(plain_table(_title(result), _COLUMNS, _rows(result)))
        for tile in result.tiles:
            for reason in tile.reasons:
                out.print(f"tile {tile.tile}: {reason}", markup=False, highlight=False, soft_wrap=True)
        out.print(
            f"{folder / FOLDER / CASE} is a decomposed case for OpenFOAM: ./Allrun runs {len(result.tiles)} processes",
            markup=False,
            highlight=False,
            soft_wrap=True,
        )


def _title(result: TiledMesh) -> str:
    lost = f", {result.cut_off_cells:,} cut off and left out" if result.cut_off_cells else ""
    return (
        f"{result.cells:,} cells in {len(result.tiles)} tiles{lost}: {result.verdict}; the fibers' volume is off by "
        f"{result.volume_error:+.2%}, {result.seconds:.3g} s"
    )


def _rows(result: TiledMesh) -> list[tuple[str, ...]]:
    return [
        (
            str(tile.tile),
            f"{tile.cells:,}",
            f"{tile.interface_faces:,}",
            f"{tile.max_non_orthogonality:.1f}",
            f"{tile.max_skewness:.2f}",
            f"{tile.mean_deviation:.4f} / {tile.typical_deviation:.3f}",
            tile.verdict,
            f"{tile.seconds:.3g} s",
            f"{tile.peak_memory / 2**30:.2f} GiB",
        )
        for tile in result.tiles
    ]
