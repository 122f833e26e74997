"""Why a stage has to run: what its result depends on, held against what made the result that is there."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from pipeline.line import store
from pipeline.line.code import code_of, libraries_of
from pipeline.line.manifest import damaged, read_manifest
from pipeline.line.results import Results
from pipeline.line.stage import Stage, giver

NO_RESULT = "no result yet"
_SHOWN = 3  # files of the program, or settings, that one reason names
_LONGEST = 60  # characters of a value that is quoted


def identity(stage: Stage, results: Results) -> dict[str, Any]:
    """All that a stage's result depends on.

    Parameters
    ----------
    stage : Stage
    results : Results
        Of the run as it stands.

    Returns
    -------
    dict
        ``parameters`` (settings by table), ``sources`` and ``inputs`` (digest by file), ``code`` (digest by file of
        the program) and ``libraries`` (version by name).
    """
    settings = results.case.model_dump(mode="json")
    if stage.shows_run:
        settings = results.case.content()
    shown = [each.section.module for each in results.line if each.section is not None] if stage.shows_run else []
    modules = dict.fromkeys([stage.make.module, *shown])
    tables = settings if stage.shows_run else (*([stage.name] if stage.settings is not None else []), *stage.reads)
    return {
        "parameters": {name: settings[name] for name in tables},
        "sources": {str(path): _digest(path) for path in stage.sources(results.case)},
        "inputs": _inputs(stage, results),
        "code": _merged(code_of(module) for module in modules),
        "libraries": _merged(libraries_of(module) for module in modules),
    }


def _merged(parts: Iterable[dict[str, str]]) -> dict[str, str]:
    return dict(sorted(item for part in parts for item in part.items()))


def _digest(path: Path) -> str:
    # a source that is missing is the stage's to tell
    return store.file_digest(path) if path.is_file() else "missing"


def _inputs(stage: Stage, results: Results) -> dict[str, str]:
    found: dict[str, str] = {}
    if stage.shows_run:
        for name, made in results.manifests().items():
            if name != stage.name:
                files = {**made["files"], **made["records"]}
                found |= {f"{name}/{file}": str(digest) for file, digest in files.items()}
        return dict(sorted(found.items()))
    for noun in (*stage.needs(results.case), *stage.takes(results.case)):
        source = giver(results.line, noun)
        manifest = results.manifest(source.name)
        if manifest is None:
            continue
        place = source.gives[noun]
        for name, digest in manifest["files"].items():
            if name == place or name.startswith(f"{place}/"):
                found[f"{source.name}/{name}"] = str(digest)
    return dict(sorted(found.items()))


def of_this_case(stage: Stage, results: Results) -> bool:
    """Whether the result that is there has the settings and inputs of this case.

    What older code or libraries made still counts; what other settings or inputs made does not.
    """
    made, now = results.manifest(stage.name) or {}, identity(stage, results)
    return all(made.get(part) == now[part] for part in ("parameters", "sources", "inputs"))


def reasons(stage: Stage, results: Results) -> tuple[str, ...]:
    """Say why a stage has to run; nothing where its result holds.

    Returns
    -------
    tuple of str
        Such as ``mat.seed changed from 1 to 7``, ``tetmesh/mesh.npz changed``, ``pipeline/mat/contact.py changed``,
        ``numba 0.60 -> 0.61``, ``no result yet``.
    """
    folder = results.folder / stage.name
    manifest = read_manifest(folder)
    if manifest is None:
        return (NO_RESULT if not folder.exists() else "its manifest is missing or damaged",)
    now = identity(stage, results)
    found = [
        *_settings(manifest["parameters"], now["parameters"]),
        *_files(manifest["sources"], now["sources"]),
        *_files(manifest["inputs"], now["inputs"]),
        *_files(manifest["code"], now["code"]),
        *_versions(manifest["libraries"], now["libraries"]),
        *(f"{stage.name}/{name} is not as it was left" for name in damaged(folder, manifest)),
    ]
    if not found and manifest["key"] != store.digest(now):
        found.append("its manifest is damaged")
    return tuple(found)


def _settings(before: Any, now: Any) -> Iterator[str]:
    changes = list(_changes(before, now, ""))
    yield from changes[:_SHOWN]
    if len(changes) > _SHOWN:
        yield f"{len(changes) - _SHOWN} more settings changed"


def _changes(before: Any, now: Any, path: str) -> Iterator[str]:
    if isinstance(before, dict) and isinstance(now, dict):
        for key in dict.fromkeys([*now, *before]):
            yield from _changes(before.get(key), now.get(key), f"{path}.{key}" if path else str(key))
    elif before != now:
        yield f"{path} changed from {_shown(before)} to {_shown(now)}"


def _shown(value: Any) -> str:
    text = "nothing" if value is None else str(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _files(before: Any, now: dict[str, str]) -> Iterator[str]:
    old = before if isinstance(before, dict) else {}
    words = []
    for name in dict.fromkeys([*now, *old]):
        if name not in old:
            words.append(f"{name} is new")
        elif name not in now:
            words.append(f"{name} is gone")
        elif old[name] != now[name]:
            words.append(f"{name} changed")
    yield from words[:_SHOWN]
    if len(words) > _SHOWN:
        yield f"{len(words) - _SHOWN} more files changed"


def _versions(before: Any, now: dict[str, str]) -> Iterator[str]:
    old = before if isinstance(before, dict) else {}
    for name in dict.fromkeys([*now, *old]):
        if old.get(name) != now.get(name):
            yield f"{name} {old.get(name, 'not there')} -> {now.get(name, 'not there')}"
