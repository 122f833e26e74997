"""Put small faults into a room's code and see whether its tests notice: ``python -m tests.mutation mat 100 [seed]``.

The faults are drawn by the seed. Each is written into a copy of the checkout, where the room's tests, but the slow ones
and those that need OpenFOAM, run until the first that fails. What survives is told on standard output.

mutmut and cosmic-ray were tried first. mutmut puts its own functions before ours, which numba cannot compile and which
`pipeline.line.code` would hash; cosmic-ray starts Python anew for each fault, and loading numba, scipy and VTK takes
longer than most tests. Here each fault runs in a fork of one process that has loaded them.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.mutation.mutants import Mutant, mutants, mutated

ROOT = Path(__file__).parents[2]
_LIBRARIES = (
    "numpy",
    "scipy.spatial",
    "scipy.sparse.linalg",
    "scipy.optimize",
    "numba",
    "pydantic",
    "pint",
)
_CLOSURES = """
import json, sys
from pipeline.line.code import closure
json.dump({name: closure(name) for name in sys.argv[1:]}, sys.stdout)
"""
_PROCESSOR, _CLOCK = 150, 900.0  # seconds that the tests may take with a fault, which may be a loop without an end


@dataclass(frozen=True)
class Room:
    """Code that gets faults, and the tests that should notice."""

    code: tuple[str, ...]
    tests: tuple[str, ...]


ROOMS = {
    "line": Room(
        tuple(
            f"pipeline/line/{name}.py" for name in ("code", "manifest", "places", "reasons", "results", "run", "store")
        ),
        ("tests/line", "tests/security/test_fuzz.py"),
    ),
    "mat": Room(("pipeline/mat/*.py",), ("tests/mat",)),
    "analytics": Room(
        ("pipeline/analytics/formulas/*.py", "pipeline/analytics/models/*.py"),
        ("pipeline/analytics", "tests/analytics"),
    ),
    "mesh": Room(
        ("pipeline/mesh/improve/*.py", "pipeline/mesh/wall_error.py", "pipeline/mesh/boundary.py"), ("tests/mesh",)
    ),
    "engines": Room(("pipeline/mesh/*.py", "pipeline/mesh/engines/**/*.py"), ("tests/mesh",)),
}


def main() -> int:
    """Try as many faults of a room as asked for; exit code 1 if one survived."""
    name, count = sys.argv[1], int(sys.argv[2])
    draw = random.Random(sys.argv[3] if len(sys.argv) > 3 else name)
    room = ROOMS[name]
    with tempfile.TemporaryDirectory(prefix="mutation-") as place:
        copy = Path(place) / "checkout"
        ignored = shutil.ignore_patterns(".git", ".venv", "runs", "build", ".*_cache", ".hypothesis")
        # with numba's machine code, which holds as long as the sources' times do
        shutil.copytree(ROOT, copy, ignore=ignored)
        for library in _LIBRARIES:
            importlib.import_module(library)
        importers = _importers(copy)
        noticed = _noticed(room.tests, copy, frozenset())
        assert not noticed, f"without a fault: {noticed}\n{(copy.parent / 'said').read_text()[-3000:]}"
        paths = sorted({path for pattern in room.code for path in copy.glob(pattern)})
        places = [(path, mutant) for path in paths for mutant in mutants(path.read_text())]
        chosen = draw.sample(places, min(count, len(places)))
        killed = 0
        for path, mutant in chosen:
            how = _fate(path, mutant, room, copy, importers)
            killed += bool(how)
            words = f"{path.relative_to(copy)}:{mutant.line}: {' '.join(mutant.told.split())[:150]}"
            sys.stdout.write(f"{'killed  ' if how else 'SURVIVED'} {words}  [{how}]\n")
            sys.stdout.flush()
    survived = len(chosen) - killed
    sys.stdout.write(f"{name}: {len(chosen)} of {len(places)} faults tried, {killed} killed, {survived} survived\n")
    return 1 if survived else 0


def _fate(path: Path, mutant: Mutant, room: Room, copy: Path, importers: dict[str, frozenset[str]]) -> str:
    """Tell what noticed a fault; nothing if none did."""
    text, times = path.read_text(), path.stat()
    name = ".".join(path.relative_to(copy).with_suffix("").parts)
    # Python trusts its own byte code by the second and the size
    for stale in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
        stale.unlink()
    path.write_text(mutated(text, mutant))
    try:
        # the module's own examples and the tests of its name first: to collect the others takes longer
        own = (path, *copy.glob(f"tests/**/test_{path.stem}.py"))
        return _noticed(tuple(map(str, own)), copy, importers[name]) or _noticed(room.tests, copy, importers[name])
    finally:
        path.write_text(text)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


def _noticed(tests: tuple[str, ...], copy: Path, stale: frozenset[str]) -> str:
    """Run tests in a fork of this process; give the first that failed, or nothing."""
    said = copy.parent / "said"
    child = os.fork()
    if child == 0:
        code = 70
        try:
            os.setsid()
            with said.open("w") as file:
                os.dup2(file.fileno(), 1)
                os.dup2(file.fileno(), 2)
            code = _run(tests, copy, stale)
        except BaseException:
            traceback.print_exc()
        finally:
            # the copy is its parent's to remove
            os._exit(code)
    deadline = time.monotonic() + _CLOCK
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            break
        if time.monotonic() > deadline:
            os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return "out of time"
        time.sleep(0.02)
    # 5: nothing to run
    if os.waitstatus_to_exitcode(status) in (0, 5):
        return ""
    lines = [line for line in said.read_text(errors="replace").splitlines() if line.startswith(("FAILED", "ERROR"))]
    return lines[0].split(" - ")[0] if lines else f"status {status}"


def _run(tests: tuple[str, ...], copy: Path, stale: frozenset[str]) -> int:
    os.chdir(copy)
    sys.dont_write_bytecode = True
    sys.path[:] = [str(copy), *(path for path in sys.path if path not in ("", str(ROOT)))]
    for module in [name for name in sys.modules if name.partition(".")[0] in ("tests", "pipeline")]:
        del sys.modules[module]
    os.environ["PYTHONPATH"] = str(copy)
    # a fault may ask for all of the memory
    resource.setrlimit(resource.RLIMIT_AS, (12 * 2**30, 12 * 2**30))
    resource.setrlimit(resource.RLIMIT_CPU, (_PROCESSOR, _PROCESSOR))
    _forget_machine_code(stale)
    temporary = copy.parent / "tmp"
    shutil.rmtree(temporary, ignore_errors=True)
    options = (
        "-x",
        "-q",
        "-m",
        "not slow and not openfoam",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:benchmark",
        "--no-header",
        f"--basetemp={temporary}",
    )
    return int(pytest.main([*options, *tests]))


def _forget_machine_code(stale: frozenset[str]) -> None:
    """Let numba compile anew what has the fault and what may hold it: its cache looks at each file alone."""
    from numba.core.dispatcher import Dispatcher

    enable = Dispatcher.enable_caching

    def cached(self: Dispatcher) -> None:
        if self.py_func.__module__ not in stale:
            enable(self)

    Dispatcher.enable_caching = cached  # type: ignore[method-assign]


def _importers(copy: Path) -> dict[str, frozenset[str]]:
    """Give the modules that import each module, straight or through others, with itself."""
    names = [".".join(path.relative_to(copy).with_suffix("").parts) for path in copy.glob("pipeline/**/*.py")]
    names = [name for name in names if not name.endswith("__init__")]
    done = subprocess.run(
        [sys.executable, "-c", _CLOSURES, *names], cwd=copy, capture_output=True, text=True, check=True
    )
    imported = json.loads(done.stdout)
    return {name: frozenset(other for other in names if name in imported[other]) for name in names}


if __name__ == "__main__":
    raise SystemExit(main())
