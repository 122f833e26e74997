"""Mesh the air by the engine that the case names, and keep the mesh, its measures and what it cost."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.line import store
from pipeline.mesh.estimate import UNSURE, slenderness_of_case, too_large
from pipeline.mesh.fill import engine_missing, fill
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh_measures import MeshingCost
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts

_COST = ("mesher_seconds", "mesher_peak_memory")


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Fill the air with cells."""
    mesh, measures = fill(results.read(FluidDomain), results.case.tetmesh, progress, into)
    store.save(mesh, into / "mesh.npz")
    kept = {each.name: getattr(measures, each.name) for each in fields(measures) if each.name not in _COST}
    store.write_json(into / "measures.json", kept)
    store.write_json(into / "cost.json", MeshingCost(measures.mesher_seconds, measures.mesher_peak_memory))
    return {"cells": measures.cells, "volume_error": measures.volume_error}


def obstacle(results: "Results") -> str | None:
    """Say why the engine cannot run on this machine, or why its mesh will not fit; None where it can and may."""
    return engine_obstacle(results) or _beyond_memory(results)


def _beyond_memory(results: "Results") -> str | None:
    """Say that the mesh will not fit by far, as far as the case alone tells."""
    settings = results.case.tetmesh
    slender = slenderness_of_case(results.case)
    if slender is None or settings.mesher.estimate is None:
        return None
    return too_large(settings.mesher.estimate(slender, settings), slender, settings, UNSURE)


def engine_obstacle(results: "Results") -> str | None:
    """Say why the engine cannot run on this machine; None where it can."""
    if results.case.mat.generator == "surface" and results.case.tetmesh.mesher.cuts_by_axes:
        return (
            f"tetmesh.engine = {results.case.tetmesh.engine} cuts fibers by their axes, and a surface has none; "
            'set it to "tetwild" or "snappy"'
        )
    return engine_missing(results.case.tetmesh)
