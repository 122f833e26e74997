# SPDX-License-Identifier: GPL-3.0-or-later

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from pipeline import child_process, guardian, machine
from pipeline.child_process import Advice, Limits
from pipeline.errors import StageError
from tests.processes.marks import Marked

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere less is promised")

# as mpirun's ranks: one in its own process group, one in its own session, one whose parent is gone
FAMILY = "sh -c 'sleep 600' & setsid sleep 600 & (setsid sleep 600 &) ; "
ADVICE = Advice("sh", "be quicker", "be smaller")


@pytest.mark.parametrize(
    ("program", "code"),
    [
        (["true"], 0),
        (["sh", "-c", "exit 7"], 7),
        (["sh", "-c", "kill -SEGV $$"], -signal.SIGSEGV),
        (["sh", "-c", "kill -KILL $$"], -signal.SIGKILL),
        (["no-such-program"], guardian.NOT_STARTED),
    ],
)
def test_a_program_ends_as_it_would_have_ended_alone(program: list[str], code: int, tmp_path: Path) -> None:
    with child_process.started(program, tmp_path, tmp_path / "log") as child:
        child_process.watch(child, lambda: "nothing")
    assert child.returncode == code
    assert ("cannot start no-such-program" in (tmp_path / "log").read_text()) is (code == guardian.NOT_STARTED)


def test_what_it_says_is_kept_behind_what_was_said_before(tmp_path: Path) -> None:
    for word in ("first", "second"):
        with child_process.started(["sh", "-c", f"echo {word}; pwd 1>&2"], tmp_path, tmp_path / "log") as child:
            child.wait()
    assert (tmp_path / "log").read_text().split("\n") == ["first", str(tmp_path), "second", str(tmp_path), ""]


@pytest.mark.parametrize("ending", ["by itself", "by the block"])
def test_all_that_it_started_ends_with_it(ending: str, tmp_path: Path) -> None:
    marked = Marked(tmp_path / "tmp")
    command = ["sh", "-c", FAMILY + ("exit 0" if ending == "by itself" else "sleep 600")]
    with child_process.started(command, tmp_path, tmp_path / "log", marked.environment) as child:
        if ending == "by itself":
            assert child.wait(20) == 0
        else:
            while len(marked.processes()) < 5:
                time.sleep(0.01)
    assert marked.left() == []


def test_what_does_not_listen_is_ended_by_force(tmp_path: Path) -> None:
    marked = Marked(tmp_path / "tmp")
    command = ["sh", "-c", "trap '' TERM INT HUP; touch ready; sleep 600; sleep 600"]
    with child_process.started(command, tmp_path, tmp_path / "log", marked.environment):
        while not (tmp_path / "ready").exists():
            time.sleep(0.01)
    assert marked.left() == []


def test_its_guardian_does_not_leave_it_alone(tmp_path: Path) -> None:
    marked = Marked(tmp_path / "tmp")
    with child_process.started(["sleep", "600"], tmp_path, tmp_path / "log", marked.environment) as child:
        while [process.name() for process in psutil.Process(child.pid).children()] != ["sleep"]:
            time.sleep(0.01)
        child.kill()
        assert child.wait() == -signal.SIGKILL
        assert marked.left() == []


_PARENT = f"""
import sys, time
from pathlib import Path
from pipeline import child_process
from pipeline.scratch import scratch_folder
with scratch_folder("mesh") as folder:
    (folder / "input").write_bytes(bytes(100_000))
    with child_process.started(["sh", "-c", {FAMILY!r} + "sleep 600"], folder, folder / "log", scratch=[folder]):
        print("started", flush=True)
        time.sleep(600)
"""


def test_a_parent_that_is_killed_at_any_moment_leaves_no_process_and_no_folder(tmp_path: Path) -> None:
    # thirty moments within the half second in which all of it starts: before, between and after
    draw = random.Random(20)
    for attempt in range(12):
        marked = Marked(tmp_path / str(attempt))
        parent = subprocess.Popen(
            [sys.executable, "-c", _PARENT], env=marked.environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )
        if attempt % 2:
            assert parent.stdout is not None
            parent.stdout.readline()
            time.sleep(draw.uniform(0, 0.1))
        else:
            while not list(marked.temporary.iterdir()) and parent.poll() is None:
                time.sleep(0.001)
            time.sleep(draw.uniform(0, 0.06))
        parent.send_signal(draw.choice([signal.SIGKILL, signal.SIGTERM]))
        parent.communicate()
        left = marked.left(4.0)
        # killed before its guardian stood, it leaves a folder, which the next one to make a folder sweeps
        assert all(name.startswith("fibertwin-mesh-") for name in left), left
        subprocess.run(
            [sys.executable, "-c", "from pipeline.scratch import sweep; sweep()"], env=marked.environment, check=True
        )
        assert marked.left(0.0) == []


def test_a_lock_outlives_its_holder_until_nothing_can_write_any_more(tmp_path: Path) -> None:
    script = (
        "import sys, time; from pathlib import Path; from pipeline import child_process, machine\n"
        f"here = Path({str(tmp_path)!r})\n"
        "with (here / 'lock').open('w') as file:\n"
        "    machine.lock(file)\n"
        "    command = ['sh', '-c', 'trap \"\" TERM; touch ready; while :; do date >> written; sleep 0.01; done']\n"
        "    with child_process.started(command, here, here / 'log'):\n"
        "        time.sleep(600)\n"
    )
    parent = subprocess.Popen([sys.executable, "-c", script])
    while not (tmp_path / "ready").exists():
        time.sleep(0.01)
    parent.kill()
    parent.wait()
    with (tmp_path / "lock").open("w") as file:
        with pytest.raises(BlockingIOError):
            machine.lock(file)
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            try:
                machine.lock(file)
                break
            except BlockingIOError:
                time.sleep(0.01)
        size = os.path.getsize(tmp_path / "written")  # noqa: PTH202
        time.sleep(0.1)
        assert (tmp_path / "written").stat().st_size == size


def test_limits_end_it_and_say_what_to_do(tmp_path: Path) -> None:
    marked = Marked(tmp_path / "tmp")
    for limits, told in (
        (Limits(seconds=0.3), "sh was ended after 0 s, the limit, while resting; be quicker"),
        (Limits(memory=1000), r"sh was ended at 0\.\d GiB of memory, over .* while resting; be smaller"),
    ):
        with (
            pytest.raises(StageError, match=told),
            child_process.started(["sh", "-c", FAMILY + "sleep 600"], tmp_path, tmp_path / "log", marked.environment)
            as child,
        ):  # fmt: skip
            child_process.watch(child, lambda: "resting", limits, ADVICE)
        assert marked.left() == []


def test_memory_counts_all_that_it_started(tmp_path: Path) -> None:
    # a grandchild of 100 MB; Python itself takes some ten
    script = "import time; held = bytearray(100_000_000); time.sleep(1.5)"
    command = ["sh", "-c", f"{sys.executable} -S -c '{script}'; true"]
    with child_process.started(command, tmp_path, tmp_path / "log") as child:
        used = child_process.watch(child, lambda: "holding")
    assert 100_000_000 < used.peak_memory < 250_000_000
    assert used.seconds > 1.5
