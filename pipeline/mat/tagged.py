"""Tables of the case file that come in kinds: one key of the table names the kind."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import (
    BaseModel,
    GetJsonSchemaHandler,
    ValidationError,
    ValidationInfo,
    WrapValidator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError


def by_key(key: str, kinds: Mapping[str, type[BaseModel]]) -> WrapValidator:
    """Make the validator of a union whose branch is named by the table's own `key`.

    pydantic's tagged union does the same, but puts the tag into the path of every error: a person who wrote
    ``mat.side`` would be told about ``mat.layered.side``.
    """

    def read(value: Any, handler: Any, info: ValidationInfo) -> Any:
        if isinstance(value, tuple(kinds.values())):
            return value
        known = ", ".join(f'"{name}"' for name in kinds)
        if not isinstance(value, dict):
            raise ValueError(f"write a table with {key} = {known}, not {value!r}")
        kind = value.get(key)
        if not isinstance(kind, str) or kind not in kinds:
            raise refusal(key, kind, f"must be one of {known}" + ("" if kind is None else f", not {kind!r}"))
        return kinds[kind].model_validate(value, context=info.context)

    return WrapValidator(read)


def key_for_text(key: str, rest: Mapping[str, str]) -> WrapValidator:
    """Make the validator that reads a bare value as the table with that `key` and the `rest`."""

    def read(value: Any, handler: Any) -> Any:
        if not isinstance(value, (str, int, float)):
            return handler(value)
        try:
            return handler({**rest, key: value})
        except ValidationError as problem:
            # the person wrote no table: tell about the value, not about a key within it
            raise ValueError(problem.errors()[0]["msg"].removeprefix("Value error, ")) from None

    return WrapValidator(read)


@dataclass(frozen=True)
class OrText:
    """Mark, for the JSON Schema, that text may stand for a whole table."""

    meaning: str
    example: str

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Give the tables' schema with text as one more branch."""
        text = {"type": "string", "description": self.meaning, "examples": [self.example]}
        return {"anyOf": [text, handler(schema)]}


def refusal(key: str, value: object, reason: str) -> ValidationError:
    """Make the error that refuses the value of a table's `key` ("stop.count" for a key further in)."""
    error = PydanticCustomError("value_error", "{reason}", {"reason": reason})
    return ValidationError.from_exception_data(
        "settings", [InitErrorDetails(type=error, loc=tuple(key.split(".")), input=value)]
    )
