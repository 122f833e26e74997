"""What a shell offers at the tabulator key: bundled cases, stages, formats and views by name, files and folders."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cyclopts.completion import CompletionContext

Completer = Callable[["CompletionContext"], list[str]]


def cases(context: "CompletionContext") -> list[str]:
    """Offer the bundled cases, and case files."""
    from pipeline.cli.bundled import bundled

    return [*bundled(), *_paths(context.incomplete, (".toml",))]


def runs(context: "CompletionContext") -> list[str]:
    """Offer folders."""
    return list(_paths(context.incomplete, ()))


def studies(context: "CompletionContext") -> list[str]:
    """Offer the bundled studies, and study files."""
    from pipeline.cli.bundled import bundled

    return [*(name for name in bundled() if "/" in name), *_paths(context.incomplete, (".toml",))]


def stages(_: "CompletionContext") -> list[str]:
    """Offer the stages of the line."""
    from pipeline.line.stages import LINE

    return [stage.name for stage in LINE]


def formats(_: "CompletionContext") -> list[str]:
    """Offer what a run is written as."""
    from pipeline.export.formats.registry import WRITTEN

    return list(WRITTEN)


def scenes(_: "CompletionContext") -> list[str]:
    """Offer the views of a run."""
    from pipeline.report.views.scenes import SCENES

    return list(SCENES)


def presets(_: "CompletionContext") -> list[str]:
    """Offer the single-fiber models."""
    from pipeline.analytics.models.single_fiber import PRESETS

    return list(PRESETS)


def pressure_models(_: "CompletionContext") -> list[str]:
    """Offer the models of the pressure drop."""
    from pipeline.analytics.models.pressure_models import MODELS

    return list(MODELS)


def generators(_: "CompletionContext") -> list[str]:
    """Offer where fibers come from."""
    from pipeline.cli.starting import GENERATORS

    return list(GENERATORS)


def _paths(begun: str, suffixes: tuple[str, ...]) -> Iterator[str]:
    """Give the folders, and the files of some suffixes, whose path begins like this, as it was begun."""
    folder = Path(begun).parent if begun and not begun.endswith(("/", os.sep)) else Path(begun or ".")
    head = begun[: len(begun) - len(Path(begun).name)] if begun and not begun.endswith(("/", os.sep)) else begun
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError:
        return
    for entry in entries:
        path = f"{head}{entry.name}"
        if entry.name.startswith(".") or not path.startswith(begun):
            continue
        if entry.is_dir():
            yield f"{path}/"
        elif entry.name.lower().endswith(suffixes) and suffixes:
            yield path
