"""`fibertwin tune`: the settings of a mat from what was measured on a filter."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import sys
from pathlib import Path

from rich.console import Console

from pipeline.case import read_case
from pipeline.cli.listen import listening
from pipeline.cli.tables import plain_table
from pipeline.design.targets import read_targets, readable
from pipeline.design.tune import Tuned, tune
from pipeline.errors import CaseError

_KEEPABLE = ("relaxation_slope", "spacing")


def tune_case(
    path: Path,
    targets: tuple[str, ...],
    overrides: tuple[str, ...],
    seeds: int,
    keep: tuple[str, ...],
    as_json: bool,
    quiet: bool,
) -> None:
    """Tune a case's mat and print the keys to paste, and what mats of these settings measure."""
    for name in keep:
        if name not in _KEEPABLE:
            raise CaseError(f"--keep {name}: only {' or '.join(_KEEPABLE)} can be kept")
    wanted = read_targets(targets)
    case = read_case(path, overrides)
    # the answer alone goes to the standard output, so that it can be sent into a file
    with listening(Console(stderr=True), quiet) as progress:
        tuned = tune(case, wanted, seeds, frozenset(keep), progress)
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(tuned), indent=2, allow_nan=False) + "\n")
        return
    sys.stdout.write(tuned.toml())
    if not quiet:
        out = Console()
        out.print(
            plain_table(_title(tuned), ("", "target", "mean", "std of one mat", f"seed {tuned.seed}"), _rows(tuned))
        )


def _title(tuned: Tuned) -> str:
    return f"{len(tuned.seeds)} mats, seeds {tuned.seeds[0]} to {tuned.seeds[-1]}; seed {tuned.seed} comes closest"


def _rows(tuned: Tuned) -> list[tuple[str, ...]]:
    targets = {target.quantity: target.value for target in tuned.targets}
    return [
        (
            "fibers" if name == "count" else name.replace("_", " "),
            readable(name, targets[name]) if name in targets else "",
            readable(name, spread.mean),
            readable(name, spread.std),
            readable(name, tuned.closest[name]),
        )
        for name, spread in tuned.measured.items()
    ]
