"""Measured figures as CSV, one line per run, so that tables and plots can be made again without measuring again."""

# SPDX-License-Identifier: GPL-3.0-or-later

import csv
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Record = TypeVar("Record", bound="DataclassInstance")


def write_records(path: Path, records: "Sequence[DataclassInstance]") -> None:
    """Write dataclasses of one kind, numbers with six digits: more would be noise of the mesher's."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([field.name for field in fields(records[0])])
        for record in records:
            writer.writerow([_text(value) for value in asdict(record).values()])


def read_records(path: Path, kind: type[Record]) -> list[Record]:
    """Read what `write_records` wrote."""
    with path.open(newline="", encoding="utf-8") as file:
        return [kind(**{field.name: _value(row[field.name]) for field in fields(kind)}) for row in csv.DictReader(file)]


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _value(text: str) -> Any:
    if text in ("True", "False"):
        return text == "True"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
