"""Interrupt every command at random moments: ``python -m tests.processes.interruptions 10 [part of a command's name]``.

Ctrl-C or SIGTERM must end a command with 130 or 143 and one sentence, with no process, no temporary folder and no half
written file left; the same command must then do its work.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from pipeline.line.manifest import read_manifest
from pipeline.line.places import MANIFEST
from tests.micrograph.drawn import as_bytes, bands
from tests.processes.kills import CASE
from tests.processes.marks import Marked

NAMES = {signal.SIGINT: "Ctrl-C", signal.SIGTERM: "SIGTERM"}
_READY = " pipeline.cli.interruption\n"  # before Python tells of this import, it is still starting itself
_LATEST = 300.0  # seconds that an interrupted command may take to end, with other programs on all cores

_FILES = {
    "case.toml": CASE,
    "mat.toml": """
[mat]
generator = "layered"
side = "10 um"
fiber_diameter = "1 um"
relaxation_slope = 0.15
max_fibers = 40
stop = { coverage = 1 }
""",
    "tiled.toml": """
[mat]
generator = "layered"
side = "26 um"
fiber_diameter = "1.4 um"
relaxation_slope = 0.15
stop = { coverage = 0.2 }
[enclosure]
inlet = "3 um"
outlet = "3 um"
[tetmesh]
engine = "lattice"
edge = 1.0
largest_edge = 2.0
deviation = 1.0
""",
    "measured.toml": """
fiber_diameter = "1.4 um +- 3 %"
solidity = "8 % +- 6 %"
thickness = "30 um +- 2 um"
seeds = 3
""",
    "study.toml": """
case = "mat.toml"
seeds = 2
measure = ["predict.mpps.diameter in nm"]
[sweep]
mat.relaxation_slope = [0.05, 0.2]
""",
}


@dataclass(frozen=True)
class Command:
    """A command line, and whether it takes more than a few seconds of a processor, and the program that it needs."""

    words: tuple[str, ...]
    slow: bool = False
    needs: tuple[str, ...] = ()

    @property
    def possible(self) -> bool:
        return not self.needs or any(map(shutil.which, self.needs))


_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "microsoft-edge")
COMMANDS = {
    "init": Command(("init", "first.toml")),
    "quality": Command(("quality", "run", "--report", "mesh.html", "--html", "model.html", "--quiet")),
    "export": Command(("export", "run", "-f", "fluent", "-f", "vtk", "-f", "stl", "--out", "exported", "--quiet")),
    "measure": Command(("measure", "web.png", "--pixel", "25 nm", "--case", "web.toml", "--quiet")),
    "twin": Command(("twin", "measured.toml", "--case", "twin.toml", "--quiet")),
    "predict": Command(("predict", "--from", "run", "--thickness", "100 um", "--json")),
    "micrograph": Command(("micrograph", "mat.toml", "mat.png")),
    "tomography": Command(("tomography", "voxels.npy", "--voxel", "0.7 um", "--case", "voxels.toml", "--quiet")),
    "study": Command(("study", "study.toml", "--workers", "2", "--out", "studied", "--quiet"), slow=True),
    "tune": Command(("tune", "mat.toml", "--target", "solidity=0.08", "--seeds", "3", "--quiet"), slow=True),
    "solve": Command(("solve", "run", "--again", "--quiet"), slow=True),
    "solve with OpenFOAM": Command(
        ("solve", "run", "--set", "solve.engine=openfoam", "--set", "solve.openfoam.cores=2", "--quiet"),
        slow=True, needs=("simpleFoam",),
    ),
    "capture": Command(("run", "case.toml", "--until", "capture", "--out", "run", "--quiet"), slow=True),
    "view": Command(("view", "run", "--html", "view.html", "--screenshot", "view.png"), slow=True),
    "report": Command(("report", "run", "other", "--pdf", "--out", "both.html", "--quiet"), slow=True, needs=_BROWSERS),
    "tiles": Command(
        ("tiles", "tiled.toml", "--tiles", "2x2", "--workers", "2", "--out", "tiled", "--quiet"), slow=True
    ),
    "permeability": Command(("permeability", "case.toml", "--out", "let_through", "--quiet"), slow=True),
    "converge": Command(("converge", "case.toml", "--out", "converged", "--quiet"), slow=True),
}  # fmt: skip


def prepare(place: Path, run: Path | None = None) -> None:
    """Make what the commands start from: cases, pictures, and two runs: copies of one, or of a small case, solved."""
    for name, content in _FILES.items():
        (place / name).write_text(content)
    Image.fromarray(as_bytes(bands(np.full(8, 12.0), (300, 320), seed=6))).save(place / "web.png")
    across = np.abs(np.arange(24) - 12.0)
    np.save(place / "voxels.npy", np.where((across < 5)[:, None, None] & np.ones((24, 24, 24), bool), 200, 20))
    if run is None:
        command = [sys.executable, "-m", "pipeline.cli", "run", "case.toml", "--out", "run", "--quiet"]
        subprocess.run([*command, "--until", "solve"], cwd=place, check=True)
    else:
        shutil.copytree(run, place / "run")
    shutil.copytree(place / "run", place / "other")


def _started(command: Command, work: Path, marked: Marked, said: Path) -> "subprocess.Popen[bytes]":
    with said.open("wb") as told:
        return subprocess.Popen(
            [sys.executable, "-X", "importtime", "-m", "pipeline.cli", *command.words],
            cwd=work, env=marked.environment, stdout=subprocess.DEVNULL, stderr=told,
        )  # fmt: skip


def _told(said: Path) -> str:
    lines = said.read_text(errors="replace").splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith("import time:"))


def _content(place: Path) -> dict[str, bytes]:
    return {str(path.relative_to(place)): path.read_bytes() for path in sorted(place.rglob("*")) if path.is_file()}


def _whole(path: Path, content: bytes) -> bool:
    """Whether a file that comes out otherwise each time is written to its end."""
    match path.suffix:
        case ".json":
            json.loads(content)
        case ".toml":
            tomllib.loads(content.decode())
        case ".npz":
            with zipfile.ZipFile(path) as archive:
                return archive.testzip() is None
        case ".html" | ".svg" | ".vtp" | ".vtu" | ".vtm":
            return content.rstrip().endswith((b"</html>", b"</svg>", b"</VTKFile>"))
        case ".pdf":
            return content.rstrip().endswith(b"%%EOF")
        case ".png":
            return content.endswith(b"IEND\xaeB`\x82")
        case ".msh":
            # sections of Fluent's are in parentheses, which stand alone where one of text ends
            return content.rstrip().endswith(b")")
        case ".stl":
            return len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")
        case _:
            return any((folder / MANIFEST).is_file() for folder in path.parents)
    return True


def interrupt(command: Command, prepared: Path, place: Path, seconds: float, draw: random.Random) -> str:
    """Interrupt a command once at a moment within so many seconds; give how it went, in a few words."""
    work, said, marked = place / "work", place / "said", Marked(place / "tmp")
    shutil.rmtree(work, ignore_errors=True)
    shutil.copytree(prepared, work)
    before = _content(work)
    number, moment = draw.choice(list(NAMES)), draw.uniform(0.0, seconds)
    child = _started(command, work, marked, said)
    while _READY not in said.read_text(errors="replace"):
        assert child.poll() is None, _told(said)
        time.sleep(0.005)
    time.sleep(0.02 + moment)
    child.send_signal(number)
    code = child.wait(_LATEST)
    words = f"{NAMES[number]} after {moment:.2f} s of {seconds:.1f}, code {code}"
    sentence = f"stopped by {NAMES[number]}; finished stages are kept, and the same command continues\n"
    # it may have been done just before
    assert (code, _told(said)) in [(128 + number, sentence), (0, "")], f"{words}: {_told(said)}"
    assert marked.left() == [], words
    after = _content(work)
    half = [name for name in after if Path(name).name.endswith((".partial", ".old", ".new")) or ".part." in name]
    assert not half, f"{words}: {half}"
    changed = [name for name, content in after.items() if content != before.get(name) and content]
    broken = [name for name in changed if code and not _whole(work / name, after[name])]
    assert not broken, f"{words}: half written {broken}"
    lost = [name for name in before if name not in after and not _of_a_stage(work / name)]
    assert not lost, f"{words}: gone {lost}"
    return words


def _of_a_stage(path: Path) -> bool:
    """Whether a file stood in a stage that is being made again."""
    return len(path.parents) > 2 and read_manifest(path.parents[0]) is None


def finish(command: Command, prepared: Path, place: Path) -> float:
    """Run a command to its end in a fresh copy; give its seconds."""
    shutil.rmtree(place / "work", ignore_errors=True)
    shutil.copytree(prepared, place / "work")
    return again(command, place)


def again(command: Command, place: Path) -> float:
    """Run a command to its end where it stands; give its seconds."""
    began = time.monotonic()
    code = _started(command, place / "work", Marked(place / "tmp"), place / "said").wait()
    assert code == 0, _told(place / "said")
    return time.monotonic() - began


def main() -> int:
    """Interrupt each command as often as asked for; exit code 1 if anything was left or half written."""
    count, part = int(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else ""
    place = Path(tempfile.mkdtemp(prefix="interruptions-"))
    (prepared := place / "prepared").mkdir()
    prepare(prepared)
    failed = 0
    for name, command in COMMANDS.items():
        if part not in name or not command.possible:
            continue
        seconds, draw, bad = finish(command, prepared, place), random.Random(name), 0
        for _ in range(count):
            try:
                words = f"{interrupt(command, prepared, place, seconds, draw)}: held"
                again(command, place)
            except (AssertionError, subprocess.TimeoutExpired) as problem:
                bad, words = bad + 1, str(problem)
            sys.stdout.write(f"  {name}: {words}\n")
            sys.stdout.flush()
        failed += bad
        sys.stdout.write(f"{name}: {count} interruptions of {seconds:.1f} s: {bad or 'none'} failed\n")
    shutil.rmtree(place)
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
