"""What a result depends on in the program: the modules that its maker imports, and the libraries that they import.

A module counts by its syntax tree without docstrings: comments, layout and documentation change no result. What runs
under ``TYPE_CHECKING`` does not count. A module that is named in a text, as `pipeline.line.stage.Entry` and child
processes name theirs, counts as imported.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import ast
import contextlib
import hashlib
import importlib.metadata
import json
import os
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
_PACKAGE = ROOT.name
_DATA = (".jinja", ".css", ".js")
_PLACE = re.compile(rf"{_PACKAGE}(\.\w+)+(:\w+)?")
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass(frozen=True, slots=True)
class Source:
    """One module: digest of its syntax tree, and the full names that it may import, ours and others'."""

    digest: str
    names: tuple[str, ...]


def read_source(text: str) -> Source:
    r"""Take apart the text of a module.

    Examples
    --------
    >>> read_source("# a remark\nimport numpy as np").names
    ('numpy',)
    >>> read_source('"Says much."\nx = 1').digest == read_source("x = 1  # says less").digest
    True
    """
    tree = ast.parse(text)
    names = tuple(sorted(set(_imported(tree))))
    for node in ast.walk(tree):
        if isinstance(node, _DOCUMENTED) and node.body and _is_text(node.body[0]):
            node.body = node.body[1:] or [ast.Pass()]
    return Source(hashlib.sha256(ast.dump(tree).encode()).hexdigest(), names)


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _imported(node: ast.AST) -> Iterator[str]:
    inner = ast.iter_child_nodes(node)
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom) and node.module:
        # a name may be a module or something within one: whoever asks finds out
        yield from (f"{node.module}.{alias.name}" for alias in node.names)
    elif isinstance(node, ast.Constant) and isinstance(node.value, str) and _PLACE.fullmatch(node.value):
        yield node.value.partition(":")[0]
    elif isinstance(node, ast.If) and _is_for_types(node.test):
        inner = iter(node.orelse)
    for each in inner:
        yield from _imported(each)


def _is_for_types(test: ast.expr) -> bool:
    return (isinstance(test, ast.Name) and test.id == "TYPE_CHECKING") or (
        isinstance(test, ast.Attribute) and test.attr == "TYPE_CHECKING"
    )


@cache
def _path(module: str) -> Path | None:
    """File of a module of ours; None where the name is something within a module."""
    base = ROOT.parent.joinpath(*module.split("."))
    for path in (base.with_suffix(".py"), base / "__init__.py"):
        if path.is_file():
            return path
    return None


def _module(name: str) -> str | None:
    """Give the module that a full name stands for or lies in."""
    while name and _path(name) is None:
        name = name.rpartition(".")[0]
    return name or None


@cache
def _source(module: str) -> Source:
    path = _path(module)
    assert path is not None
    content = path.read_bytes()
    key = hashlib.sha256(content).hexdigest()
    known = _known()
    if key not in known:
        known[key] = read_source(content.decode("utf-8"))
        _NEW.append(key)
    return known[key]


_NEW: list[str] = []


def _memory() -> Path:
    # beside what Python itself keeps of these files, and for this version of it: trees differ between versions
    return ROOT / "__pycache__" / f"sources-{sys.implementation.cache_tag}.json"


@cache
def _known() -> dict[str, Source]:
    """Give the sources that were taken apart before, by the digest of their bytes."""
    try:
        content = json.loads(_memory().read_text(encoding="utf-8"))
        return {key: Source(str(digest), tuple(map(str, names))) for key, (digest, names) in content.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}


def _remember() -> None:
    if not _NEW:
        return
    _NEW.clear()
    side = _memory().with_suffix(f".{os.getpid()}")
    with contextlib.suppress(OSError):
        side.parent.mkdir(exist_ok=True)
        side.write_text(json.dumps({key: [each.digest, each.names] for key, each in _known().items()}))
        side.replace(_memory())


@cache
def closure(module: str) -> tuple[str, ...]:
    """All modules of the package that a module imports, straight or through others, with itself, sorted."""
    found: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        found.add(name)
        inner = {_module(each) for each in _source(name).names if each.split(".")[0] == _PACKAGE}
        waiting += [each for each in inner if each is not None and each != _PACKAGE]
    return tuple(sorted(found))


@cache
def code_of(module: str) -> dict[str, str]:
    """Digest of each file that a module runs, by its path from the checkout."""
    files = {}
    folders = set()
    for name in closure(module):
        path = _path(name)
        assert path is not None
        files[path.relative_to(ROOT.parent).as_posix()] = _source(name).digest
        folders.add(path.parent)
    for folder in folders:
        for path in _data_files(folder):
            files[path.relative_to(ROOT.parent).as_posix()] = hashlib.sha256(path.read_bytes()).hexdigest()
    _remember()
    return dict(sorted(files.items()))


def _data_files(folder: Path) -> Iterator[Path]:
    """Templates and the like beside a module, not those of packages below it."""
    for path in folder.iterdir():
        if path.suffix in _DATA:
            yield path
        elif path.is_dir() and not (path / "__init__.py").exists() and path.name != "__pycache__":
            yield from _data_files(path)


@cache
def libraries_of(module: str) -> dict[str, str]:
    """Installed version of each library that a module runs, by its distribution's name."""
    outside = {
        each.split(".")[0] for name in closure(module) for each in _source(name).names if each.split(".")[0] != _PACKAGE
    }
    return versions(sorted(outside - sys.stdlib_module_names))


def versions(imported: Iterable[str]) -> dict[str, str]:
    """Installed version of each library, of those that are installed, by its distribution's name."""
    found = {}
    for name in imported:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            # imported under another name than it is distributed under
            for distribution in _distributions().get(name, ()):
                found[distribution.lower()] = importlib.metadata.version(distribution)
    return dict(sorted(found.items()))


@cache
def _distributions() -> dict[str, list[str]]:
    return dict(importlib.metadata.packages_distributions())
