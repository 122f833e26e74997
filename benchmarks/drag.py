"""What a user waits for: processor seconds from a case to its pressure drop, by engine and edge.

`python -m benchmarks.drag FOLDER array` runs the square array of solidity 0.1 against its exact drag, and
`python -m benchmarks.drag FOLDER CASE` any case, named or by its file. Every run is a process of its own; seconds are
those of it and all that it starts, the solver apart from the rest.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import os
import subprocess
import sys
from pathlib import Path

from pipeline.case import Case, read_case
from pipeline.cli.bundled import found
from pipeline.line.run import Run, run
from pipeline.nouns.flow import Solution
from pipeline.nouns.quality import QualityReport
from validation.ladder import climb, rung_case

RUNS = {
    "tetwild": ({"growth": 0.4}, (0.8, 0.6, 0.4, 0.3, 0.24, 0.16)),
    "snappy": ({"growth": 0.4}, (0.8, 0.6, 0.4, 0.3, 0.24, 0.16, 0.12)),
    "lattice": ({}, (0.8, 0.6, 0.5, 0.4, 0.3, 0.24)),
}
"""By engine: settings that differ from the default, and edges in fiber diameters."""


def cases(case: Case, array: bool) -> list[tuple[str, float, Case]]:
    """Give every run's case."""
    found_cases = []
    for engine, (changes, edges) in RUNS.items():
        for edge in edges:
            mesh = {"engine": engine, "edge": edge, "largest_edge": max(3.0, 4.1 * edge), **changes}
            base = rung_case(case, 0.1, 1.0) if array else case
            meshed = type(base.tetmesh).model_validate(mesh)
            found_cases.append((engine, edge, base.model_copy(update={"tetmesh": meshed})))
    return found_cases


def one(spec: Path, array: bool, until: str) -> None:
    """Run a case to a stage, in the process of its own."""
    case, folder = Case.model_validate_json(spec.read_text()), spec.with_suffix("")
    if until == "solve" and array:
        (spec.with_suffix(".error")).write_text(f"{climb(case, folder).error:+.2%}")
    else:
        run(case, folder, until=until, without=frozenset({"report"}))


def seconds(spec: Path, array: bool, until: str) -> float:
    """Processor seconds of one run."""
    command = [sys.executable, "-m", "benchmarks.drag", str(spec), "array" if array else "case", "--until", until]
    with spec.with_suffix(".log").open("ab") as log:
        child = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(child.pid, 0)
    return usage.ru_utime + usage.ru_stime if status == 0 else float("nan")


def main(folder: Path, what: str) -> None:
    """Run all and print a table."""
    array = what == "array"
    folder.mkdir(parents=True, exist_ok=True)
    case = read_case(found(Path("cases/verification/square.toml" if array else what)))
    last = "error of F*" if array else "pressure drop"
    print(f"| engine | edge [d] | cells | case to mesh and files | solver | together | iterations | {last} |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    for engine, edge, each in cases(case, array):
        spec = folder / f"{engine}-{edge:g}.json"
        spec.write_text(json.dumps(each.model_dump(mode="json")))
        meshed, solved = (seconds(spec, array, until) for until in ("compare", "solve"))
        this = Run(each, spec.with_suffix(""))
        if not (this.folder / "solve").exists():
            print(f"| {engine} | {edge:g} | failed, see {spec.with_suffix('.log').name} | | | | | |", flush=True)
            continue
        result = spec.with_suffix(".error").read_text() if array else f"{this.read(Solution).pressure_drop:.3f} Pa"
        print(
            f"| {engine} | {edge:g} | {this.read(QualityReport).cells:,} | {meshed:.1f} s | {solved:.1f} s | "
            f"{meshed + solved:.1f} s | {this.read(Solution).iterations} | {result} |",
            flush=True,
        )


if __name__ == "__main__":
    if "--until" in sys.argv:
        one(Path(sys.argv[1]), sys.argv[2] == "array", sys.argv[4])
    else:
        main(Path(sys.argv[1]), sys.argv[2])
