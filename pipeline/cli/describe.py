"""What the case file may hold, read off the settings themselves: for `fibertwin init` and the reference in docs/."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import types
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel, WithJsonSchema
from pydantic.fields import FieldInfo

from pipeline.mat.tagged import OrText
from pipeline.units import written

_WORDS = {
    "m": "length",
    "m/s": "velocity",
    "kelvin": "temperature",
    "Pa": "pressure",
    "Pa*s": "viscosity",
    "kg/m^3": "density",
    "s": "time",
    "byte": "memory",
    "degree": "angle",
    "": "number or percentage",
}
_EXAMPLES = {"m": '"12 um"', "Pa*s": '"1.8e-5 Pa*s"', "kg/m^3": '"1.2 kg/m^3"', "byte": '"4 GiB"', "Pa": '"320 Pa"'}


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a table: its name, what it takes, what it is when left out, and what it means.

    `default` and `example` are written as in a file; a key without a default is `required` or simply not set.
    `tables` are the kinds of table that may stand as its value.
    """

    name: str
    takes: str
    default: str | None
    example: str | None
    required: bool
    meaning: str
    tables: tuple[type[BaseModel], ...]


@dataclass(frozen=True, slots=True)
class _Part:
    # one alternative of a key's type, with what is annotated on it
    kind: Any
    notes: tuple[object, ...]


def keys(settings: type[BaseModel]) -> Iterator[Key]:
    """Give the keys of a table in the order in which they are declared."""
    for name, info in settings.model_fields.items():
        parts = list(_parts(info.annotation, tuple(info.metadata)))
        yield Key(
            name=name,
            takes=" or ".join(dict.fromkeys(text for part in parts if (text := _takes(part)))),
            default=_default(info, parts),
            example=next((sample for part in parts if (sample := _example(part))), None),
            required=info.is_required(),
            meaning=_sentence(info.description or settings.__doc__ or ""),
            tables=tuple(table for part in parts for table in _tables(part.kind)),
        )


def summary(settings: type[BaseModel]) -> str:
    """First paragraph of what a table says about itself, without the hint at its own place in the file."""
    text = " ".join((settings.__doc__ or "").split("\n\n")[0].split())
    return text.split(" (case file:")[0].rstrip(".") + "."


def _sentence(text: str) -> str:
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "?")) else text + "."


def _parts(annotation: Any, notes: tuple[object, ...]) -> Iterator[_Part]:
    """Take unions and annotations apart; a union's own notes go to its alternatives."""
    if get_origin(annotation) is Annotated:
        inner, *own = get_args(annotation)
        yield from _parts(inner, (*notes, *_unpacked(own)))
    elif get_origin(annotation) in (Union, types.UnionType):
        marks = [note for note in notes if isinstance(note, OrText)]
        yield from (_Part(str, (mark,)) for mark in marks)
        rest = tuple(note for note in notes if not isinstance(note, OrText))
        for option in get_args(annotation):
            yield from _parts(option, rest)
    elif annotation is not type(None):
        yield _Part(annotation, tuple(_unpacked(notes)))


def _unpacked(notes: Iterable[object]) -> Iterator[object]:
    for note in notes:
        if isinstance(note, FieldInfo):
            yield from note.metadata
        else:
            yield note


def _unit(part: _Part) -> str | None:
    for note in part.notes:
        if isinstance(note, WithJsonSchema) and note.json_schema is not None:
            schema = note.json_schema
            return str(schema["x-unit"] if "x-unit" in schema else schema["anyOf"][1]["x-unit"])
    return None


def _tables(kind: Any) -> tuple[type[BaseModel], ...]:
    kinds = get_args(kind) if get_origin(kind) is tuple else (kind,)
    return tuple(one for one in kinds if _is_table(one))


def _is_table(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def _takes(part: _Part) -> str:
    mark = next((note for note in part.notes if isinstance(note, OrText)), None)
    if mark is not None:
        return f'text such as "{mark.example}"'
    measured, kind = _unit(part), part.kind
    if measured is not None:
        return _WORDS[measured] + _range(part, measured)
    if get_origin(kind) is Literal:
        return " or ".join(f'"{name}"' for name in get_args(kind))
    if get_origin(kind) is tuple:
        element = get_args(kind)[0]
        if get_origin(element) is Annotated:
            return "list, each a " + _takes(next(_parts(element, ())))
        return "list of " + ("tables" if _is_table(element) else ", ".join(f'"{name}"' for name in get_args(element)))
    if _is_table(kind):
        return "a table"
    names: dict[Any, str] = {bool: "true or false", int: "whole number", Path: "path", str: "text"}
    return names[kind] + _range(part, "")


def _range(part: _Part, unit: str) -> str:
    lows = [(float(note.ge), ">=") for note in part.notes if isinstance(note, Ge)]  # type: ignore[arg-type]
    lows += [(float(note.gt), ">") for note in part.notes if isinstance(note, Gt)]  # type: ignore[arg-type]
    highs = [(float(note.le), "<=") for note in part.notes if isinstance(note, Le)]  # type: ignore[arg-type]
    highs += [(float(note.lt), "<") for note in part.notes if isinstance(note, Lt)]  # type: ignore[arg-type]
    # a field may narrow what its type allows: the tightest bound is the one that holds
    bounds = [*([max(lows)] if lows else []), *([min(highs)] if highs else [])]
    return " " + ", ".join(f"{sign} {_bound(limit, unit)}" for limit, sign in bounds) if bounds else ""


def _bound(limit: float, unit: str) -> str:
    if limit == 2.0**63:
        return "2^63"
    return "0" if limit == 0 else written(limit, unit)


def _default(info: FieldInfo, parts: list[_Part]) -> str | None:
    value = info.default
    if info.is_required() or value is None or info.default_factory is not None:
        return None
    unit = next((unit for part in parts if (unit := _unit(part)) is not None), None)
    if unit is not None and unit != "":
        return f'"{written(float(value), unit)}"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return written(value, "")
    if isinstance(value, tuple) and get_origin(parts[0].kind) is tuple:
        unit = _unit(next(_parts(get_args(parts[0].kind)[0], ())))
        if unit:
            return json.dumps([written(float(each), unit) for each in value])
    return json.dumps(list(value) if isinstance(value, tuple) else value)


def _example(part: _Part) -> str | None:
    mark = next((note for note in part.notes if isinstance(note, OrText)), None)
    if mark is not None:
        return f'"{mark.example}"'
    unit = _unit(part)
    if unit is not None:
        return _EXAMPLES.get(unit)
    return {bool: "true", int: "1", str: '"davies"'}.get(part.kind) if isinstance(part.kind, type) else None
