"""What a process does: make a piece of the mesh, or write a tile."""

# SPDX-License-Identifier: GPL-3.0-or-later

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT
from pipeline.errors import StageError
from pipeline.export.formats.openfoam.case import write_processor
from pipeline.export.formats.openfoam.slip import FiberSlip, fiber_radius
from pipeline.geometry.parts import parts
from pipeline.line import store
from pipeline.line.run import Run
from pipeline.machine import peak_memory
from pipeline.mesh.engines.lattice.engine import LONGER, LatticeSettings
from pipeline.mesh.engines.limits import within
from pipeline.mesh.tiles.faces import beside_others, tile_of
from pipeline.mesh.tiles.make import PieceMesh, make_piece
from pipeline.mesh.tiles.plan import Piece, TilePlan
from pipeline.mesh.wall_error import wall_deviation
from pipeline.mesh.wall_fibers import wall_fibers
from pipeline.nouns.arrays import Bools, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.tiled import TileReport
from pipeline.progress import silent
from pipeline.quality.judge import judge

CASE = "openfoam"
"""Folder of the case beside the pieces."""


@dataclass(frozen=True, eq=False, slots=True)
class Made:
    """What is told of a piece.

    Parameters
    ----------
    number : int
    cells : int
    sizes : (parts,) int array
        Cells of each part that hangs together.
    at_inlet : (parts,) bool array
        Whether air enters it.
    toward : dict of int to (k,) int array
        The part at each face that a tile shares with another one, in the order that both find.
    seconds : float [s]
        Of processor time.
    peak_memory : int [byte]
    """

    number: int
    cells: int
    sizes: Ints
    at_inlet: Bools
    toward: dict[int, Ints]
    seconds: float
    peak_memory: int


def piece_file(folder: Path, number: int) -> Path:
    """Where a piece is kept."""
    return folder / f"piece{number}.npz"


def make_and_keep(run: Path, folder: Path, plan: TilePlan, piece: Piece, *before: Made) -> Made:
    """Make a piece of a run's mesh out of the files of earlier ones, and keep it in a file.

    Parameters
    ----------
    run : Path
        Folder of the run, up to its duct.
    folder : Path
        Of the pieces.
    plan : TilePlan
    piece : Piece
    before : Made
        The pieces that it names: that they are given means that they are there.

    Returns
    -------
    Made

    Raises
    ------
    StageError
        If cells without volume remain.
    """
    began = time.process_time()
    results = Run.opened(run)
    earlier = {made.number: store.load(PieceMesh, piece_file(folder, made.number)) for made in before}
    settings = results.case.tetmesh
    limit = settings.own(LatticeSettings).time_limit
    progress = within(limit, f"the lattice of {piece.kind} {piece.number}", LONGER, silent)
    mesh = make_piece(piece, plan, results.read(FluidDomain), settings, earlier, progress)
    del earlier
    store.save(mesh, piece_file(folder, piece.number))
    sizes, at_inlet = np.array([len(mesh.tets)]), np.array([True])
    toward: dict[int, Ints] = {}
    if piece.kind == "tile":
        sizes, at_inlet, toward = _joints(mesh, piece.number - plan.strips)
    return Made(piece.number, len(mesh.tets), sizes, at_inlet, toward, time.process_time() - began, peak_memory())


def _joints(mesh: PieceMesh, number: int) -> tuple[Ints, Bools, dict[int, Ints]]:
    """Tell how the parts of a tile hang on other tiles."""
    cell, side = np.nonzero(mesh.across >= 0)
    count, part = parts(cell, mesh.across[cell, side], len(mesh.tets))
    at_inlet = np.zeros(count, np.bool_)
    # the inlet is the first patch: -1 stands for what is behind it
    at_inlet[part[(mesh.across == -1).any(axis=1)]] = True
    tile = tile_of(number, mesh, np.ones(len(mesh.tets), np.bool_))
    of_cell = part[tile.order]
    toward = (
        {
            other: of_cell[tile.mesh.owner[patch.start : patch.start + patch.count]]
            for other, patch in zip(tile.neighbors, tile.mesh.patches[-len(tile.neighbors) :], strict=True)
        }
        if tile.neighbors
        else {}
    )
    return np.bincount(part, minlength=count), at_inlet, toward


def write_tile(run: Path, folder: Path, plan: TilePlan, made: Made, kept: Bools) -> TileReport:
    """Judge a tile and write it as one process of a decomposed case.

    Parameters
    ----------
    run : Path
    folder : Path
        Of the pieces; the case goes into a folder of it.
    plan : TilePlan
    made : Made
        What was told of it.
    kept : (parts,) bool array
        Parts that air flows through.

    Returns
    -------
    TileReport
    """
    began = time.process_time()
    results = Run.opened(run)
    case, domain = results.case, results.read(FluidDomain)
    piece, number = store.load(PieceMesh, piece_file(folder, made.number)), made.number - plan.strips
    cell, side = np.nonzero(piece.across >= 0)
    _, part = parts(cell, piece.across[cell, side], len(piece.tets))
    beside, own = beside_others(piece)
    report = judge(beside, case.quality, own=own)
    del beside, own
    tile = tile_of(number, piece, kept[part])
    mesh = replace(tile.mesh, fiber=wall_fibers(tile.mesh, domain))
    flow, slip = case.flow.flow(), None
    if case.flow.fiber_wall == "slip":
        slip = FiberSlip(SLIP_COEFFICIENT * flow.mean_free_path, fiber_radius(mesh, domain.radius))
    write_processor(mesh, folder / CASE, number, tile.neighbors, flow, case.enclosure.sides, case.export, slip)
    mean, typical, _ = wall_deviation(mesh, domain)
    if not (report.metrics["volume"].min > 0.0):
        raise StageError(f"tile {number} holds cells without volume: {'; '.join(report.reasons)}; lower tetmesh.edge")
    verdict, reasons, allowed = report.verdict, report.reasons, case.tetmesh.deviation
    if typical > allowed:
        told = (
            f"a hundredth of its walls is farther than {typical:.3g} diameters from its fiber, allowed is {allowed:g}"
        )
        verdict, reasons = "fail", (told, *reasons)
    return TileReport(
        tile=number,
        neighbors=tile.neighbors,
        cells=mesh.cells,
        points=len(mesh.points),
        interface_faces=sum(patch.count for patch in mesh.patches[len(domain.patches) :]),
        volume=mesh.volume,
        verdict=verdict,
        reasons=reasons,
        max_non_orthogonality=report.metrics["non_orthogonality"].max,
        max_skewness=report.metrics["skewness"].max,
        mean_deviation=mean,
        typical_deviation=typical,
        seconds=made.seconds + time.process_time() - began,
        peak_memory=max(made.peak_memory, peak_memory()),
    )
