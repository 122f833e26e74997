"""Particles of one size sent through the filter in batches, on all cores, until enough have an end."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.capture.cells import Cells
from pipeline.capture.contact import FiberGrid
from pipeline.capture.intervals import share_interval
from pipeline.capture.langevin import Motion
from pipeline.capture.starts import starts
from pipeline.capture.trajectories import CAPTURED, TIMED_OUT, Duct, Fates, Pace, tracked
from pipeline.line.places import remove
from pipeline.line.store import DAMAGE, read_arrays
from pipeline.machine import cores

BATCH = 500
"""Particles that are followed in one go: the work that a killed run loses at most, per core."""

_KINDS = {"outcome": np.int64, "piece": np.int64, "place": np.float64, "time": np.float64, "steps": np.int64}
_FIRST_COUNT = 1000
_LARGEST_COUNT = 10_000_000


@dataclass(frozen=True, eq=False, slots=True)
class Filter:
    """What particles of one size meet.

    Parameters
    ----------
    duct : Duct
    cells : Cells
    grid : FiberGrid
        With a reach beyond the particle's radius.
    fastest : float [m/s]
        Largest velocity into the duct.
    """

    duct: Duct
    cells: Cells
    grid: FiberGrid
    fastest: float


def counted(
    filter: Filter, motion: Motion, pace: Pace, seed: int, size: int, count: int | None, half_width: float | None,
    kept: Path | None = None,
) -> Iterator[Fates]:  # fmt: skip
    """Follow particles of one size, and give what became of all of them so far after each round.

    Parameters
    ----------
    filter : Filter
    motion : Motion
    pace : Pace
    seed, size : int
        Name the random numbers.
    count : int, optional
        How many particles; without it as many as `half_width` needs.
    half_width : float [-], optional
        Half the width of the efficiency's interval to end at; at most 10 million particles.
    kept : Path, optional
        Folder that finished batches are kept in and taken from.

    Yields
    ------
    Fates
        Of all particles so far, in the order of their numbers.
    """

    def follow(first: int, end: int) -> Fates:
        return _batch(first, end - first, filter, motion, pace, seed, size, kept)

    done: list[Fates] = []
    wanted = count or _FIRST_COUNT
    with ThreadPoolExecutor(max_workers=cores()) as threads:
        while True:
            while BATCH * len(done) < wanted:
                ahead = range(BATCH * len(done), wanted, BATCH)[: 2 * cores()]
                # whole batches unless the count is given, so that a batch is the same whatever comes after it
                ends = [min(at + BATCH, wanted) if count else at + BATCH for at in ahead]
                done += threads.map(follow, ahead, ends)
                yield joined(done)
            so_far = joined(done)
            if count or half_width is None:
                return
            caught, lost = int((so_far.outcome == CAPTURED).sum()), int((so_far.outcome == TIMED_OUT).sum())
            trials = len(so_far.outcome)
            low, high = share_interval(caught, trials, lost)
            width = 0.5 * (high - low)
            if width <= half_width or trials >= _LARGEST_COUNT:
                return
            # the width falls as the root of the count; a little more, so that the next round is the last
            needed = int(1.05 * trials * (width / half_width) ** 2)
            wanted = min(max(needed, trials + BATCH), 8 * trials, _LARGEST_COUNT)


def _batch(
    first: int, count: int, filter: Filter, motion: Motion, pace: Pace, seed: int, size: int, kept: Path | None
) -> Fates:
    path = kept / f"{size}_{first}_{count}.npz" if kept is not None else None
    if path is not None and path.exists() and (found := _kept(path, count)) is not None:
        return found
    places = starts(first, count, seed, filter.duct, filter.cells, filter.fastest)
    fates = tracked(places, first, seed, size, motion, filter.duct, pace, filter.cells, filter.grid)
    if path is not None:
        side = path.with_suffix(".partial.npz")
        for place in (side, path):
            remove(place)
        np.savez(side, **fates._asdict())
        side.rename(path)
    return fates


def _kept(path: Path, count: int) -> Fates | None:
    """Read a batch of an earlier try; None where it is damaged."""
    try:
        found = read_arrays(path)
        shapes = [found[name].shape for name in Fates._fields]
    except DAMAGE:
        return None
    whole = shapes == [(count, 3) if name == "place" else (count,) for name in Fates._fields]
    whole = whole and all(found[name].dtype == kind for name, kind in _KINDS.items())
    return Fates(**{name: found[name] for name in Fates._fields}) if whole else None


def joined(parts: list[Fates]) -> Fates:
    """Put batches together, in their order."""
    return Fates(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
