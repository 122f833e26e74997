"""`fibertwin export`: any format of a run that is there, without running it again."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import sys
from pathlib import Path

from pydantic import BaseModel, ConfigDict
from rich.console import Console

from pipeline.case import Case, override, validate_as
from pipeline.cli.listen import listening
from pipeline.errors import CaseError
from pipeline.export.formats.registry import WRITTEN, held, why_not
from pipeline.export.make import order_of
from pipeline.export.settings import ExportSettings
from pipeline.export.write import write_all
from pipeline.line.manifest import read_manifest
from pipeline.line.places import disk_trouble_explained, locked, own_folder
from pipeline.line.run import Run


class _Changes(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    export: ExportSettings


def export_run(
    folder: Path, formats: tuple[str, ...], out: Path | None, overrides: tuple[str, ...], as_json: bool, quiet: bool
) -> None:
    """Write formats of a finished run, each into a folder of its own."""
    _refuse_unknown(formats)
    run = Run.opened(folder)
    case = _changed(run.case, overrides)
    run = Run(case, folder, left_out=run.left_out)
    place = out if out is not None else own_folder(folder, "export")
    made = _made_by_the_run(folder) if out is None else set()
    if overrides and (mine := [name for name in formats if name in made]):
        raise CaseError(f"{place / mine[0]} belongs to the run, which has other settings; choose a folder with --out")
    # what the run made stays as its manifest says
    wanted = tuple(name for name in dict.fromkeys(formats) if name not in made)
    with listening(Console(stderr=True), quiet or as_json) as progress:
        things: dict[type, object] = {of: run.read(of) for of in held(wanted)}
        with locked(folder), disk_trouble_explained(place):
            write_all(wanted, things, place, order_of(run, wanted, progress))
    where = {name: str(place / name) for name in formats}
    if as_json:
        sys.stdout.write(json.dumps(where, indent=2) + "\n")
    elif not quiet:
        for name, path in where.items():
            Console().print(f"{name}: {path}", markup=False, highlight=False, soft_wrap=True)


def _refuse_unknown(formats: tuple[str, ...]) -> None:
    known = f"known: {', '.join(WRITTEN)}"
    if not formats:
        raise CaseError(f"--format is missing: which file do you want? {known}")
    for name in formats:
        if name not in WRITTEN:
            reason = why_not(name)
            raise CaseError(f"--format {name}: {name} {reason}" if reason else f"--format {name}: unknown; {known}")


def _changed(case: Case, overrides: tuple[str, ...]) -> Case:
    for text in overrides:
        if not text.startswith("export."):
            raise CaseError(
                f"--set {text}: only keys of export can be changed for a run that is there; fibertwin run makes another"
            )
    typed = validate_as(_Changes, override({"export": {}}, overrides), "--set").export.model_dump(exclude_unset=True)
    return case.model_copy(update={"export": case.export.model_copy(update=typed)})


def _made_by_the_run(folder: Path) -> set[str]:
    manifest = read_manifest(folder / "export") or {"files": {}}
    return {name.partition("/")[0] for name in manifest["files"]}
