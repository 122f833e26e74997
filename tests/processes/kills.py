"""Kill runs at random moments: ``python -m tests.processes.kills 50 [part of a variant's name [signal]]``.

Each run is ended by SIGKILL, SIGTERM or Ctrl-C at a moment anywhere in its stages and in the programs that they start.
Then no process and no temporary folder may be left, and the same command must end in the results of a run that nobody
ended.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import hashlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.line.manifest import read_manifest
from tests.processes.marks import Marked

CASE = """# One fiber in the middle of a duct: each stage takes a moment
[mat]
generator = "array"
arrangement = "square"
solidity = "10 %"
fiber_diameter = "1 um"
rows = 1
[enclosure]
inlet = "2 um"
outlet = "2 um"
"""
SIGNALS = {signal.SIGKILL: -9, signal.SIGTERM: 143, signal.SIGINT: 130}


@dataclass(frozen=True)
class Variant:
    """A way through the line.

    Parameters
    ----------
    until : str
        Its last stage.
    settings : tuple of str
    random : tuple of str
        Stages that give other bytes each time.
    needs : str
        A program, where it needs one.
    made : str
        The last stage that is there before each run, so that a kill hits what comes after.
    """

    until: str
    settings: tuple[str, ...]
    random: tuple[str, ...] = ()
    needs: str = ""
    made: str = ""

    @property
    def possible(self) -> bool:
        return not self.needs or shutil.which(self.needs) is not None


_AFTER = ("tetmesh", "quality", "export", "compare", "solve", "report")
VARIANTS = {
    "lattice, to the report": Variant("report", ("tetmesh.engine=lattice",), ("report",)),
    "fTetWild": Variant("export", ("tetmesh.engine=tetwild",), _AFTER),
    "snappyHexMesh": Variant("quality", ("tetmesh.engine=snappy",), (), "snappyHexMesh"),
    "snappyHexMesh on two cores": Variant(
        "quality", ("tetmesh.engine=snappy", "tetmesh.snappy.cores=2"), _AFTER, "snappyHexMesh"
    ),
    "the flow, by elements": Variant("solve", ("tetmesh.engine=lattice",), ("solve", "report")),
    "the flow, by OpenFOAM": Variant(
        "solve", ("tetmesh.engine=lattice", "solve.engine=openfoam"), ("solve", "report"), "simpleFoam"
    ),
    "the flow, by OpenFOAM on two cores": Variant(
        "solve",
        ("tetmesh.engine=lattice", "solve.engine=openfoam", "solve.openfoam.cores=2"),
        ("solve", "report"),
        "simpleFoam",
    ),
    "the solver of OpenFOAM alone, on two cores": Variant(
        "solve",
        ("tetmesh.engine=lattice", "solve.engine=openfoam", "solve.openfoam.cores=2"),
        ("solve", "report"),
        "simpleFoam",
        made="export",
    ),
}


@dataclass
class Kills:
    """Kills of one variant, against a run that nobody ended.

    Parameters
    ----------
    variant : Variant
    place : Path
        An empty folder.
    """

    variant: Variant
    place: Path
    reference: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0

    def __post_init__(self) -> None:
        (self.place / "case.toml").write_text(CASE)
        if self.variant.made:
            assert self.started(Marked(self.place / "tmp"), self.place / "made", self.variant.made).wait() == 0
        for attempt in ("warm", "reference"):
            began = time.monotonic()
            self.copied(self.place / attempt)
            done = self.started(Marked(self.place / "tmp"), self.place / attempt).wait()
            assert done == 0, f"the run itself failed in {self.place / attempt}"
            self.seconds = time.monotonic() - began
        self.reference = self.results(self.place / "reference")

    def copied(self, run: Path) -> None:
        """Give a run the stages that are there before."""
        if self.variant.made:
            shutil.copytree(self.place / "made", run)

    def started(self, marked: Marked, run: Path, until: str = "") -> "subprocess.Popen[bytes]":
        command = [sys.executable, "-m", "pipeline.cli", "run", str(self.place / "case.toml"), "--quiet"]
        options = [part for setting in self.variant.settings for part in ("--set", setting)]
        with (self.place / "said").open("ab") as said:
            return subprocess.Popen(
                [*command, "--out", str(run), "--until", until or self.variant.until, *options],
                env=marked.environment,
                stdout=said,
                stderr=said,
            )

    def results(self, run: Path) -> dict[str, str]:
        """Digest of each file of each stage that gives the same each time; of the others, that they are there."""
        found = {}
        for stage in sorted(path for path in run.iterdir() if path.is_dir()):
            manifest = read_manifest(stage)
            assert manifest is not None, f"{stage} has no manifest"
            for name, digest in manifest["files"].items():
                same = stage.name not in self.variant.random or name == "solution.json"
                if stage.name == "solve" and "/" in name:
                    # how many states a solver keeps depends on how often it was started
                    continue
                found[f"{stage.name}/{name}"] = (
                    hashlib.sha256((stage / name).read_bytes()).hexdigest() if same else "there"
                )
                assert not same or found[f"{stage.name}/{name}"] == digest
        return found

    def kill(self, draw: random.Random, signals: Sequence[signal.Signals] = tuple(SIGNALS)) -> str:
        """End one run at a random moment, check what is left, and let it go on; tell in a few words how it went."""
        marked = Marked(self.place / "tmp")
        run = self.place / f"run-{draw.getrandbits(32):08x}"
        number, moment = draw.choice(signals), draw.uniform(0.0, self.seconds)
        self.copied(run)
        child = self.started(marked, run)
        time.sleep(moment)
        child.send_signal(number)
        code = child.wait()
        words = f"{signal.Signals(number).name} after {moment:.2f} s of {self.seconds:.1f}, code {code}"
        # Python itself dies of SIGTERM, and tells of Ctrl-C, while it starts
        assert code in (0, SIGNALS[number], -number, 1 if moment < 0.5 else 0), words
        left = marked.left()
        # a process that is killed before its guardian stands leaves a folder that the next start sweeps
        assert all(name.startswith("fibertwin-") for name in left), f"{words}: {left}"
        if run.exists() and number != signal.SIGKILL:
            half = [path.name for path in run.iterdir() if path.suffix in (".partial", ".old", ".new")]
            assert not half, f"{words}: {half}"
        assert self.started(marked, run).wait() == 0, f"{words}: it does not go on in {run}"
        assert marked.left() == [], words
        names = {path.name for path in run.iterdir() if path.suffix in (".partial", ".old", ".new", ".kept")}
        assert not names, f"{words}: {names}"
        assert self.results(run) == self.reference, f"{words}: other results in {run}"
        shutil.rmtree(run)
        return words


def main() -> int:
    """Kill as many runs of each variant as asked for; exit code 1 if anything was left or came out otherwise."""
    count, part = int(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else ""
    signals = (signal.Signals[sys.argv[3]],) if len(sys.argv) > 3 else tuple(SIGNALS)
    failed = 0

    def tell(words: str) -> None:
        sys.stdout.write(f"{words}\n")
        sys.stdout.flush()

    for name, variant in VARIANTS.items():
        if part not in name or not variant.possible:
            continue
        place = Path(tempfile.mkdtemp(prefix="kills-"))
        began, bad = time.monotonic(), []
        kills = Kills(variant, place)
        draw = random.Random(name)
        for _ in range(count):
            try:
                tell(f"  {name}: {kills.kill(draw, signals)}: held")
            except AssertionError as problem:
                bad.append(str(problem))
                tell(f"  {name}: {problem}")
        failed += len(bad)
        outcome = "held" if not bad else "; ".join(bad)
        tell(f"{name}: {count} kills in {time.monotonic() - began:.0f} s: {outcome}")
        if not bad:
            shutil.rmtree(place)
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
