"""Darcy's permeability of a mat along its three axes: the mat is turned, so that the same line solves each."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np

from pipeline.cad.fibers import write_fibers
from pipeline.case import Case
from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.line.places import own_file
from pipeline.line.run import Run, run
from pipeline.mat.settings import FileSettings
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.permeability import AlongAxis, Permeability
from pipeline.nouns.surface import Surface
from pipeline.progress import Progress

OTHERS = "permeability"
"""Folder in a run's that holds the runs of the turned mat."""
_MARGIN = 0.25
"""Mean fiber diameters of air, at least, between a turned mat and the sides where its top and its bottom were."""
_AXES = {"x": (1, 2, 0), "y": (2, 0, 1)}
"""Which of the mat's axes become the duct's x, y and z: the last one lies along the flow."""
_UNNEEDED = frozenset({"quality", "export", "capture", "structure", "micrograph", "report"})


def permeability(case: Case, folder: Path, progress: Progress) -> Permeability:
    """Solve the flow through a mat along its three axes.

    Parameters
    ----------
    case : Case
    folder : Path
        Of the case's own run, whose flow along z is the third; the others stand in a folder of it. Finished runs are
        used again.
    progress : Progress

    Returns
    -------
    Permeability

    Raises
    ------
    CaseError
        If the medium has no fibers to turn.
    StageError
        If a run fails.
    """
    if case.mat.generator == "surface":
        raise CaseError('generator = "surface": a body is not turned here; turn its file, and run each as a case')
    through = _solved(case, folder, "z", progress)
    results = Run(case, folder)
    mat, solidity = results.read(Mat), results.read(Surface).solidity
    found = {}
    for name in _AXES:
        place = folder / OTHERS / name
        place.mkdir(parents=True, exist_ok=True)
        file = own_file(place / "fibers.csv")
        write_fibers(turned(mat, name), file)
        # every table stays as the case has it but the mat's
        other = case.model_copy(update={"mat": FileSettings(file=file.resolve(), outside="cut")})
        found[name] = _solved(other, place, name, progress)
    entries = (found["x"].permeability, found["y"].permeability, through.permeability)
    a, b, c = (tuple(row) for row in np.diag(entries).tolist())
    return Permeability(
        case=folder.resolve().name,
        fiber_wall=case.flow.fiber_wall,
        solidity=solidity,
        x=found["x"],
        y=found["y"],
        z=through,
        tensor=(a, b, c),
        in_plane_over_through=0.5 * (entries[0] + entries[1]) / entries[2],
    )


def turned(mat: Mat, axis: str) -> Mat:
    """Turn a mat so that the flow runs along one of the axes of its plane.

    Parameters
    ----------
    mat : Mat
    axis : "x" or "y"
        Along which the flow is to run.

    Returns
    -------
    Mat
        The mat's top and bottom are sides now, a quarter of a mean diameter off the fibers or more; axes may leave it
        along the flow.
    """
    order = list(_AXES[axis])
    wanted = _MARGIN * 2.0 * float(mat.radius.mean())
    size = np.array(mat.slab.size)[order]
    level = order.index(2)
    nodes = (mat.nodes - mat.slab.lower)[:, order]
    around = np.repeat(mat.radius, np.diff(mat.first))
    below = max(0.0, wanted - float((nodes[:, level] - around).min()))
    above = max(0.0, wanted - float((size[level] - nodes[:, level] - around).min()))
    nodes[:, level] += below
    size[level] += below + above
    first, radius = mat.first, mat.radius
    if mat.periodic:
        nodes, first, radius = _with_images(nodes, mat, size, level)
    slab = Box((0.0, 0.0, 0.0), (float(size[0]), float(size[1]), float(size[2])))
    return Mat(nodes, first, radius, slab, mat.seed, f"{mat.origin}, turned: the flow runs along {axis}")


def _with_images(nodes: Floats, mat: Mat, size: Floats, level: int) -> tuple[Floats, Ints, Floats]:
    """Add to each fiber its periodic images that meet the slab."""
    kept, counts, radius = [], [], []
    wraps = [axis for axis in range(3) if axis != level]
    for k in range(mat.fibers):
        own = nodes[mat.first[k] : mat.first[k + 1]]
        ranges = []
        for axis in wraps:
            low, high = own[:, axis].min(), own[:, axis].max()
            # no image that only touches a side
            ranges.append(np.arange(np.floor(-high / size[axis]) + 1, np.ceil((size[axis] - low) / size[axis])))
        for i in ranges[0]:
            for j in ranges[1]:
                shift = np.zeros(3)
                shift[wraps] = (i * size[wraps[0]], j * size[wraps[1]])
                kept.append(own + shift)
                counts.append(len(own))
                radius.append(mat.radius[k])
    return np.concatenate(kept), np.concatenate([[0], np.cumsum(counts)]), np.array(radius)


def _solved(case: Case, folder: Path, name: str, progress: Progress) -> AlongAxis:
    def told(what: str, done: float | None = None) -> None:
        progress(f"along {name}: {what}", done)

    run(case, folder, "solve", progress=told, without=_UNNEEDED)
    results = Run(case, folder)
    solution, slab = results.read(Solution), results.read(Surface).slab
    return AlongAxis(solution.permeability, solution.pressure_drop, slab.size[2], slab.face_area, str(folder))
