"""The case-file reference as a page, made from the settings (docs/reference/case_file.md)."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator

from pydantic import BaseModel

from pipeline.case import Case
from pipeline.cli.describe import Key, keys, summary

_OPENING = """# Case file: every key

Made by `fibertwin schema --markdown` from the settings themselves; a test fails when this page is not what they say.
`fibertwin init` writes the same as a case file to fill in, `fibertwin schema` gives the JSON Schema for an editor.

A value with a unit is text: `"1.4 um"`, `"2.5 cm/s"`, `"20 degC"`. A bare number is refused there, because a bare
number is where a factor of a million hides. What has no unit is a number, or a percentage as text (`0.095`, `"9.5 %"`).
An unknown key is an error that names the nearest known one. `--set table.key=value` overrides a key for one run.
"""
_KINDS = ("generator", "distribution", "law")
"""Keys that name the kind of the table they stand in; the section's title has them."""


def case_file_reference() -> str:
    """Give the page."""
    return _OPENING + "".join(f"\n{section}" for section in _sections())


def _sections() -> Iterator[str]:
    told: set[type[BaseModel]] = set()
    for key in keys(Case):
        yield f"## [{key.name}]\n\n{key.meaning}\n"
        several = len(key.tables) > 1
        for table in key.tables:
            yield from _tables(table, key.name, told, several)


def _tables(table: type[BaseModel], path: str, told: set[type[BaseModel]], titled: bool) -> Iterator[str]:
    """Give a table's section, and then those of the tables that stand as values in it, each once."""
    if table in told:
        return
    told.add(table)
    described = list(keys(table))
    if titled:
        yield f"### [{path}]{_kind(described)}\n\n{summary(table)}\n"
    rows = [key for key in described if key.name not in _KINDS]
    if rows:
        yield _rows(rows)
    for key in described:
        for nested in key.tables:
            yield from _tables(nested, f"{path}.{key.name}", told, True)


def _kind(described: list[Key]) -> str:
    # one key of a table that comes in kinds names the kind
    return next((f" {key.name} = {key.default}" for key in described if key.name in _KINDS), "")


def _rows(described: list[Key]) -> str:
    lines = ["| key | takes | when left out | meaning |", "|---|---|---|---|"]
    for key in described:
        default = (
            "**must be given**" if key.required else (f"`{key.default}`" if key.default is not None else "not set")
        )
        cells = (f"`{key.name}`", key.takes.replace("<", "&lt;").replace(">", "&gt;"), default, key.meaning)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"
