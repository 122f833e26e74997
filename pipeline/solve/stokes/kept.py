"""What a stopped solve goes on from: the iterations so far, written beside the stage every so often.

The vectors of the iterations are kept as they are, so that a solve that was stopped ends in the same bits as one that
was not: only what they took is saved.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import math
import os
import time
from pathlib import Path

import numpy as np

from pipeline.line.places import own_folder, placed, remove, write_text
from pipeline.line.store import DAMAGE, read_arrays
from pipeline.nouns.arrays import Floats
from pipeline.progress import NOTE, Progress, silent
from pipeline.reading import read_bytes
from pipeline.solve.stokes.system import DuctFlow

EVERY = 20.0
"""Seconds between two times of writing: a solve that takes less writes nothing."""
_SECONDS = "seconds"
_LONGEST = 100  # bytes of a number of seconds


class KeptSolve:
    """The folder of a solve that may be stopped.

    Parameters
    ----------
    folder : Path, optional
        Of this very mesh, case and program; nothing is kept where there is none.
    tell : Progress
        Told what is taken over and what is not, with the reason.

    Attributes
    ----------
    iterations : int
        That were taken over.
    before : float [s]
        That runs took which were stopped.
    """

    def __init__(self, folder: Path | None = None, tell: Progress = silent) -> None:
        self.folder, self.tell = folder, tell
        self.began = self.written = time.monotonic()
        self.iterations = 0
        self.before = 0.0
        if folder is not None and folder.is_dir():
            try:
                self.before = _seconds(read_bytes(folder / _SECONDS, _LONGEST, links=False).decode("ascii"))
            except DAMAGE:
                # how long it took is no reason to leave what was found
                tell(f"{NOTE}solve: how long the stopped run took is not known")

    @property
    def due(self) -> bool:
        """Whether it is time to write."""
        return self.folder is not None and time.monotonic() - self.written >= EVERY

    def write(self, name: str, **arrays: Floats) -> None:
        """Keep arrays under a name, whole or not at all."""
        if self.folder is None:
            return
        try:
            own_folder(self.folder)
            with placed(self._place(name)) as file:
                np.savez(file, **arrays)  # type: ignore[arg-type]
            write_text(self.folder / _SECONDS, f"{self.before + time.monotonic() - self.began:.3f}")
        except OSError as problem:
            # the flow can be solved all the same
            self.tell(f"{NOTE}solve: nothing is kept to go on from, should this run be stopped: {problem}")
            with contextlib.suppress(OSError):
                remove(self.folder)
            self.folder = None
        self.written = time.monotonic()

    def read(self, name: str, **shapes: tuple[int, ...]) -> dict[str, Floats] | None:
        """Read finite arrays of these shapes, -1 for any number; None if they are not there or not so."""
        if self.folder is None or not os.path.lexists(self._place(name)):
            return None
        try:
            found = read_arrays(self._place(name))
            for key, shape in shapes.items():
                _check(key, found[key], shape)
        except DAMAGE as problem:
            self.tell(f"{NOTE}solve: {name} of the run that was stopped is left, and made again: {problem}")
            return None
        return found

    def drop(self, pattern: str) -> None:
        """Remove what is kept under names of a pattern."""
        if self.folder is not None:
            for path in self.folder.glob(f"{pattern}.npz"):
                remove(path)

    def took_over(self, wall: str, iterations: int) -> None:
        """Say that iterations were taken over."""
        self.iterations += iterations
        self.tell(f"{NOTE}solve: {wall}, {iterations} iterations are those of a run that was stopped")

    def _place(self, name: str) -> Path:
        assert self.folder is not None
        return self.folder / f"{name}.npz"


def _seconds(text: str) -> float:
    found = float(text)
    if not 0.0 <= found < math.inf:
        raise ValueError(f"{text} is no time")
    return found


def _check(name: str, array: Floats, shape: tuple[int, ...]) -> None:
    fits = len(shape) == array.ndim and all(
        asked in (-1, there) for asked, there in zip(shape, array.shape, strict=True)
    )
    if array.dtype != np.float64 or not fits or not np.isfinite(array).all():
        raise ValueError(f"{name} is no array of finite numbers of shape {shape}")


class KeptIterations:
    """The iterations of one flow: the start of each round of them, and its vectors.

    Parameters
    ----------
    solve : KeptSolve
    name : str
        Of the flow.

    Attributes
    ----------
    history : list of (int, float)
        Iterations and the drop at each look; whoever looks adds to it.
    residuals : list of float
        At each look, likewise.
    """

    def __init__(self, solve: KeptSolve, name: str) -> None:
        self.solve, self.name = solve, name
        self.history: list[tuple[int, float]] = []
        self.residuals: list[float] = []
        self.start = self.known = 0

    def begin(self, start: Floats) -> tuple[Floats, int]:
        """Give what to start from, and the iterations that led to it."""
        found = self.solve.read(f"{self.name}-round", x=start.shape, history=(-1, 3), done=())
        if found is None:
            return start.copy(), 0
        self.history += [(int(at), float(drop)) for at, drop, _ in found["history"]]
        self.residuals += [float(size) for size in found["history"][:, 2]]
        self.start = int(found["done"])
        self.solve.took_over(self.name.replace("_", " "), self.start)
        return found["x"], self.start

    def recall(self, basis: Floats, hessenberg: Floats) -> int:
        """Put back the vectors of a round that are kept, and give how many iterations they make."""
        self.known = 0
        while self.known < len(basis) - 2:
            found = self.solve.read(
                self._vectors(self.known), vectors=(-1, basis.shape[1]), columns=(len(hessenberg), -1)
            )
            if found is None:
                break
            count = len(found["vectors"])
            if not 0 < count <= len(basis) - 2 - self.known or found["columns"].shape[1] != count:
                break
            basis[self.known + 1 : self.known + 1 + count] = found["vectors"]
            hessenberg[:, self.known : self.known + count] = found["columns"]
            self.known += count
        if self.known:
            self.solve.took_over(self.name.replace("_", " "), self.known)
        return self.known

    def keep(self, basis: Floats, hessenberg: Floats, count: int) -> None:
        """Write what a round has of vectors beyond those that are kept, if it is time."""
        if count > self.known and self.solve.due:
            new = slice(self.known, count)
            self.solve.write(
                self._vectors(self.known), vectors=basis[self.known + 1 : count + 1], columns=hessenberg[:, new]
            )
            self.known = count

    def again(self, found: Floats, done: int) -> None:
        """Start another round from an iterate; it is kept if anything of this solve is."""
        before, self.start = self._vectors(0)[:-3], done
        if self.known or self.solve.due:
            rows = [(at, drop, size) for (at, drop), size in zip(self.history, self.residuals, strict=True)]
            self.solve.write(f"{self.name}-round", x=found, history=np.array(rows), done=np.array(float(done)))
        self.solve.drop(f"{before}-*")

    def _vectors(self, first: int) -> str:
        return f"{self.name}-{self.start:05d}-{first:02d}"


def keep_flow(solve: KeptSolve, name: str, flow: DuctFlow) -> None:
    """Keep a flow that is solved, if it is time or its iterations are kept; these are let go."""
    rest = np.array([flow.drop, flow.error, flow.balance, flow.leak, float(flow.settled)])
    if solve.due or (solve.folder is not None and any(solve.folder.glob(f"{name}-*"))):
        solve.write(
            f"{name}-flow", velocity=flow.velocity, pressure=flow.pressure, force=flow.force, rest=rest,
            history=np.array(flow.history, dtype=np.float64),
        )  # fmt: skip
    for part in ("round", "step", "[0-9]*"):
        solve.drop(f"{name}-{part}")


def kept_flow(solve: KeptSolve, name: str, unknowns: int, vertices: int) -> DuctFlow | None:
    """Give a flow that was solved and kept."""
    found = solve.read(
        f"{name}-flow", velocity=(unknowns, 3), pressure=(vertices,), force=(unknowns, 3), rest=(5,), history=(-1, 2)
    )
    if found is None or not len(found["history"]):
        return None
    drop, error, balance, leak, settled = (float(value) for value in found["rest"])
    history = tuple((int(at), float(value)) for at, value in found["history"])
    solve.took_over(name.replace("_", " "), history[-1][0])
    return DuctFlow(
        found["velocity"], found["pressure"], found["force"], drop, error, balance, leak, history, bool(settled)
    )
