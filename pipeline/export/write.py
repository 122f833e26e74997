"""Every format that a case asks for, each in a folder of its own."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Mapping
from pathlib import Path

from pipeline.errors import StageError
from pipeline.export.formats.format import Order
from pipeline.export.formats.openfoam.slip import FiberSlip
from pipeline.export.formats.registry import WRITTEN
from pipeline.export.settings import ExportSettings
from pipeline.line.places import remove
from pipeline.nouns.arrays import Floats
from pipeline.nouns.flow import Flow
from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import Progress, silent


def export(
    mesh: FaceMesh,
    folder: Path,
    settings: ExportSettings,
    flow: Flow,
    sides: str,
    progress: Progress = silent,
    fields: Mapping[str, Floats] | None = None,
    slip: FiberSlip | None = None,
) -> tuple[str, ...]:
    """Write a mesh in every format of `settings` into ``folder/<format>``.

    A format that cannot hold the mesh does not take the others with it: they are written, and the error comes after.

    Parameters
    ----------
    mesh : FaceMesh
    folder : Path
        Made if it is not there.
    settings : ExportSettings
    flow : Flow
    sides : "symmetry", "slip" or "cyclic"
        What the duct's sides are to a solver.
    progress : Progress
    fields : mapping of name to (cells,) array, optional
        Shown on the cells by VTK.
    slip : FiberSlip, optional
        How far the air slips along the fibers; it stands still on them without.

    Returns
    -------
    tuple of str
        The formats written.

    Raises
    ------
    FormatsFailedError
        If a format cannot hold what it is asked to; the others are there, and nothing half written.
    """
    order = Order(settings, flow, sides, fields or {}, slip, progress)
    return write_all(settings.formats, {FaceMesh: mesh}, folder, order)


def write_all(formats: tuple[str, ...], things: Mapping[type, object], folder: Path, order: Order) -> tuple[str, ...]:
    """Write formats of a run's nouns, each into ``folder/<format>``; a format that fails leaves the others.

    Parameters
    ----------
    formats : tuple of str
    things : mapping of type to object
        What the formats hold: the mesh, the fibers' surface, the mat.
    folder : Path
    order : Order

    Returns
    -------
    tuple of str
        The formats written.

    Raises
    ------
    FormatsFailedError
        As `export`.
    """
    failed: dict[str, str] = {}
    for name in formats:
        try:
            write_one(name, things[WRITTEN[name].of], folder, order)
        except StageError as problem:
            failed[name] = str(problem)
    if failed:
        raise FormatsFailedError(tuple(name for name in formats if name not in failed), failed)
    return formats


class FormatsFailedError(StageError):
    """Some formats could not be written; `written` are there, `failed` says why of the rest."""

    def __init__(self, written: tuple[str, ...], failed: dict[str, str]) -> None:
        self.written, self.failed = written, failed
        there = f"{', '.join(written)} {'is' if len(written) == 1 else 'are'} written" if written else "none is written"
        super().__init__(
            "; ".join(f"cannot write {name}: {reason}" for name, reason in failed.items())
            + f" ({there}; take {' and '.join(failed)} out of export.formats, or change what stands in the way)"
        )


def write_one(name: str, thing: object, folder: Path, order: Order) -> None:
    """Write one format of what it holds into ``folder/<name>``, whole or not at all.

    Raises
    ------
    StageError
        If the format cannot hold the mesh.
    """
    kind = WRITTEN[name]
    assert kind.write is not None
    if kind.cells == "tetrahedra" and isinstance(thing, FaceMesh) and not thing.tetrahedral:
        raise StageError(
            f"{name} holds tetrahedra only, and the mesh has other cells: take openfoam, vtk or fluent "
            "in export.formats, or a tetmesh.engine that makes tetrahedra"
        )
    place, side = folder / name, folder / f".{name}.partial"
    remove(side)
    side.mkdir(parents=True)
    try:
        kind.write(thing, side, order)
        _refuse_to_lose(place, side)
        remove(place)
        side.rename(place)
    finally:
        remove(side)


def _refuse_to_lose(place: Path, side: Path) -> None:
    """Refuse to take the place of a folder in which somebody keeps something else."""
    if place.is_symlink() or not place.is_dir():
        return
    written = {path.relative_to(side) for path in side.rglob("*")}
    others = sorted(path.relative_to(place) for path in place.rglob("*"))
    others = [path for path in others if path not in written]
    if others:
        raise StageError(
            f"{place} holds {len(others)} files and folders that this export does not write, first {others[0]}; "
            "move them, or choose another folder with --out"
        )
