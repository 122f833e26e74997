# SPDX-License-Identifier: GPL-3.0-or-later

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.processes.marks import Marked

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals")

# a callback of C's, where Python throws away what is raised: numba's compiler has such ones
_THROWN_AWAY = """
import ctypes, sys, time
from pathlib import Path
from pipeline.cli.interruption import interruptible
deadline = time.monotonic() + 0.5
kind = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
def compare(a, b):
    while time.monotonic() < deadline:
        pass
    return 0
with interruptible():
    try:
        print("ready", flush=True)
        ctypes.CDLL(None).qsort((ctypes.c_int * 2)(1, 2), 2, 4, kind(compare))
        time.sleep(600)
    finally:
        # longer than the time after which an interruption is raised again
        time.sleep(0.4)
        try:
            raise ValueError
        except ValueError:
            time.sleep(0.2)
        Path(sys.argv[1]).write_text("cleaned")
"""


def sentence(name: str) -> str:
    return f"stopped by {name}; finished stages are kept, and the same command continues\n"


@pytest.mark.parametrize(("number", "name"), [(signal.SIGINT, "Ctrl-C"), (signal.SIGTERM, "SIGTERM")])
def test_an_interruption_that_a_library_throws_away_arrives_all_the_same(
    number: int, name: str, tmp_path: Path
) -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", _THROWN_AWAY, tmp_path / "done"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert child.stdout is not None
    child.stdout.readline()
    time.sleep(0.1)
    child.send_signal(number)
    _, told = child.communicate(timeout=60)
    assert (child.returncode, told) == (128 + number, sentence(name))
    # and what cleans up after it is left in peace
    assert (tmp_path / "done").read_text() == "cleaned"


@pytest.mark.parametrize("attempt", range(5))
def test_a_run_stops_at_any_moment_with_one_sentence_and_nothing_half_written(attempt: int, tmp_path: Path) -> None:
    # the first two while it still loads, the others anywhere in the seconds of a small run
    draw = random.Random(attempt)
    marked = Marked(tmp_path / "tmp")
    number, name = draw.choice([(signal.SIGINT, "Ctrl-C"), (signal.SIGTERM, "SIGTERM")])
    command = [sys.executable, "-X", "importtime", "-m", "pipeline.cli", "run", "smoke", "--quiet"]
    child = subprocess.Popen(
        [*command, "--until", "surface", "--out", tmp_path / "run"],
        env=marked.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert child.stderr is not None
    # before this line Python itself still starts
    for line in child.stderr:
        if line.endswith(" pipeline.cli.interruption\n"):
            break
    time.sleep(0.05 + draw.uniform(0, 0.4 if attempt < 2 else 3.0))
    child.send_signal(number)
    out, told = child.communicate(timeout=60)
    told = "".join(line for line in told.splitlines(True) if not line.startswith("import time:"))
    # it may have been done just before
    assert (child.returncode, told) in [(128 + number, sentence(name)), (0, "")]
    assert out == ""
    assert marked.left() == []
    if (tmp_path / "run").exists():
        names = {path.name for path in (tmp_path / "run").iterdir()}
        assert names <= {".lock", "case.json", "mat", "surface"}
        assert all((tmp_path / "run" / stage / "manifest.json").exists() for stage in names & {"mat", "surface"})


def test_what_is_ignored_stays_ignored() -> None:
    # as a job in the background of a shell ignores Ctrl-C
    script = (
        "import os, signal; from pipeline.cli.interruption import interruptible\n"
        "signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
        "with interruptible(): os.kill(os.getpid(), signal.SIGINT); print('goes on')\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "goes on\n"


def test_other_errors_that_are_thrown_away_are_still_told() -> None:
    script = (
        "from pipeline.cli.interruption import interruptible\n"
        "class Odd:\n    def __del__(self): raise ValueError('in a finalizer')\n"
        "with interruptible(): Odd()\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "in a finalizer" in done.stderr


def test_a_second_signal_ends_it_on_the_spot(tmp_path: Path) -> None:
    script = (
        "import atexit, os, signal, time; from pipeline.cli.interruption import interruptible\n"
        "atexit.register(lambda: (os.write(1, b'ending'), time.sleep(600)))\n"
        "with interruptible(): os.kill(os.getpid(), signal.SIGINT)\n"
    )
    child = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=dict(os.environ)
    )
    assert child.stdout is not None
    assert child.stdout.read(6) == b"ending"
    child.send_signal(signal.SIGINT)
    child.communicate(timeout=60)
    assert child.returncode == -signal.SIGINT


@pytest.mark.parametrize("code", [0, 2])
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_a_signal_while_python_itself_ends_changes_nothing(name: str, code: int) -> None:
    # all is written and said, but libraries take their time to go
    last = f"sys.exit({code})" if code else "pass"
    script = (
        "import atexit, os, signal, sys; from pipeline.cli.interruption import interruptible\n"
        f"atexit.register(lambda: os.kill(os.getpid(), signal.{name}))\n"
        f"with interruptible(): {last}\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (code, "")


def test_an_interruption_waits_while_a_compiled_module_is_loaded() -> None:
    # VTK's crash where an exception comes from what they import themselves; the class is named as Python's own
    script = (
        "import os, signal, sys, time; from pipeline.cli.interruption import interruptible\n"
        "class ExtensionFileLoader:\n"
        "    def exec_module(self):\n"
        "        os.kill(os.getpid(), signal.SIGTERM); time.sleep(0.3); print('loaded', flush=True)\n"
        "with interruptible(): ExtensionFileLoader().exec_module(); time.sleep(600)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=120)
    assert (done.returncode, done.stdout) == (143, "loaded\n")
    assert done.stderr.startswith("stopped by SIGTERM")


def test_an_interruption_that_a_library_makes_another_error_of_is_one() -> None:
    script = (
        "import os, signal; from pipeline.cli.interruption import interruptible\n"
        "with interruptible():\n"
        "    try: os.kill(os.getpid(), signal.SIGTERM)\n"
        "    except BaseException as problem: raise ValueError('schema') from problem\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 143
    assert done.stderr.startswith("stopped by SIGTERM")
    assert "Traceback" not in done.stderr


def test_a_bug_keeps_its_traceback() -> None:
    script = "from pipeline.cli.interruption import interruptible\nwith interruptible(): raise ValueError('a bug')\n"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "ValueError: a bug" in done.stderr
