"""Mesh a case in tiles: each piece by a process of its own, and no memory ever holds more than one."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
import shutil
import time
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.case import Case
from pipeline.errors import CaseError, StageError
from pipeline.export.formats.openfoam.case import write_around_processors
from pipeline.geometry.parts import parts
from pipeline.line import store
from pipeline.line.places import own_file
from pipeline.line.run import Run, run
from pipeline.mesh.estimate import slenderness
from pipeline.mesh.make import engine_obstacle
from pipeline.mesh.tiles.plan import TilePlan, plan, refuse_uncut
from pipeline.nouns.arrays import Bools
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.tiled import RESULT, TiledMesh, TileReport
from pipeline.progress import NOTE, Progress
from pipeline.study.workers import client_of
from pipeline.tiles.work import CASE, Made, make_and_keep, write_tile

if TYPE_CHECKING:
    from distributed import Client, Future

FOLDER = "tiles"
"""Folder in a run's that holds the pieces, the case and what is told of them."""
_WORST = ("pass", "warn", "fail")
_PROCESS, _CELL = 7.5e8, 330.0  # bytes of a process, and for each cell of its tile: docs/meshing.md


def tiled(
    case: Case,
    folder: Path,
    counts: tuple[int, int],
    workers: int | None,
    scheduler: str | None,
    progress: Progress,
) -> TiledMesh:
    """Mesh a case in tiles and write it as a case of OpenFOAM that is decomposed already.

    Parameters
    ----------
    case : Case
        Whose engine is the lattice.
    folder : Path
        Of the run, whose mat, surface and duct are made or used again.
    counts : (int, int)
        Tiles along x and y.
    workers, scheduler
        As in `pipeline.study.workers.carried_out`.
    progress : Progress

    Returns
    -------
    TiledMesh
        Kept too, as ``tiles/tiles.json``; the case is in ``tiles/openfoam``.

    Raises
    ------
    CaseError
        If the case cannot be cut so.
    StageError
        If a piece fails.
    """
    began = time.monotonic()
    refuse_uncut(case.tetmesh, case.enclosure.sides == "cyclic")
    if (reason := engine_obstacle(Run(case, folder))) is not None:
        raise CaseError(reason)
    run(case, folder, "enclosure", progress=progress, without=frozenset({"report"}))
    domain = Run(case, folder).read(FluidDomain)
    cut = plan(domain, case.tetmesh, counts)
    _announce(case, domain, cut, progress)
    place = folder / FOLDER
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    with client_of(workers, scheduler) as client:
        made = _made(client, folder, place, cut, progress)
        tiles = [each for each in made if each.number >= cut.strips]
        kept, lost = flowing(tiles, cut)
        futures = [
            client.submit(write_tile, folder.resolve(), place.resolve(), cut, each, which, pure=False, retries=0)
            for each, which in zip(tiles, kept, strict=True)
        ]
        progress("writing the tiles", 0.9)
        reports: list[TileReport] = _results(futures)
    for piece in cut.pieces():
        (place / f"piece{piece.number}.npz").unlink()
    write_around_processors(place / CASE, cut.tiles, case.flow.flow(), case.enclosure.sides, case.export)
    volume = sum(each.volume for each in reports)
    error = domain.volume_error(volume)
    worst = max((each.verdict for each in reports), key=_WORST.index)
    found = TiledMesh(
        counts=counts,
        tiles=tuple(reports),
        cells=sum(each.cells for each in reports),
        fluid_volume=volume,
        volume_error=error,
        verdict=worst if abs(error) <= case.tetmesh.volume_error else "fail",
        cut_off_cells=lost,
        strip_seconds=sum(each.seconds for each in made if each.number < cut.strips),
        seconds=time.monotonic() - began,
    )
    store.write_json(own_file(place / RESULT), found)
    return found


def _announce(case: Case, domain: FluidDomain, cut: TilePlan, progress: Progress) -> None:
    estimate = case.tetmesh.mesher.estimate
    if estimate is not None:
        whole = estimate(slenderness(domain), case.tetmesh)
        each = _PROCESS + _CELL * whole.cells / cut.tiles
        progress(
            f"{NOTE}some {whole.cells:,.2g} cells in {cut.tiles} tiles, about {each / 2**30:.1f} GiB for each process"
        )


def _made(client: "Client", run_folder: Path, place: Path, cut: TilePlan, progress: Progress) -> list[Made]:
    """Make all pieces, each as soon as those before it are there."""
    from distributed import as_completed

    pieces = cut.pieces()
    futures: dict[int, Future] = {}
    for piece in pieces:
        before = [futures[number] for number in piece.before]
        futures[piece.number] = client.submit(
            make_and_keep, run_folder.resolve(), place.resolve(), cut, piece, *before, pure=False, retries=0
        )
    names = {future.key: piece for piece, future in zip(pieces, futures.values(), strict=True)}
    for count, future in enumerate(as_completed(futures.values())):
        done = names[future.key]
        progress(f"meshing: {done.kind} {done.number}, {count + 1} of {len(pieces)} pieces", 0.9 * count / len(pieces))
    return _results(futures.values())


def _results(futures: "Iterable[Future]") -> list[Any]:
    """Give what tasks gave.

    Raises
    ------
    StageError
        If a worker ended under one.
    """
    from distributed import KilledWorker

    try:
        return [future.result() for future in futures]
    except KilledWorker as problem:
        raise StageError(
            f"a process ended while it made a tile, most likely without memory ({problem}); "
            "take more tiles, or fewer --workers at once"
        ) from problem


def flowing(tiles: list[Made], cut: TilePlan) -> tuple[list[Bools], int]:
    """Tell which parts of the tiles air flows through, and how many cells are cut off.

    Parameters
    ----------
    tiles : list of Made
    cut : TilePlan

    Returns
    -------
    kept : list of (parts,) bool arrays
        For each tile.
    lost : int
    """
    first = np.concatenate([[0], np.cumsum([len(each.sizes) for each in tiles])])
    ends: list[tuple[int, int]] = []
    for each in tiles:
        number = each.number - cut.strips
        for other, part in each.toward.items():
            back = tiles[other].toward[number]
            pairs = np.unique(np.column_stack([first[number] + part, first[other] + back]), axis=0)
            ends += [(int(a), int(b)) for a, b in pairs]
    one, two = np.array(ends, np.int64).reshape(-1, 2).T
    _, whole = parts(one, two, int(first[-1]))
    at_inlet = np.concatenate([each.at_inlet for each in tiles])
    fed = np.isin(whole, np.unique(whole[at_inlet]))
    sizes = np.concatenate([each.sizes for each in tiles])
    return [fed[a:b] for a, b in itertools.pairwise(first)], int(sizes[~fed].sum())
