"""The study file: which case, which keys take which values, how often, and what is told of each run."""

# SPDX-License-Identifier: GPL-3.0-or-later

import difflib
import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from pipeline.case import read_toml
from pipeline.errors import CaseError
from pipeline.line.run import STAGES
from pipeline.study.quantity import PREDICTED, Quantity, read_quantity


def flat(table: dict[str, Any]) -> dict[str, Any]:
    """Give nested tables as one with dotted keys; what a quoted dotted key holds is left whole.

    Examples
    --------
    >>> flat({"mat": {"stop": {"coverage": 4}}, "mat.fiber_diameter": {"distribution": "uniform"}})
    {'mat.stop.coverage': 4, 'mat.fiber_diameter': {'distribution': 'uniform'}}
    """
    result: dict[str, Any] = {}
    for key, value in table.items():
        if isinstance(value, dict) and "." not in key:
            result |= {f"{key}.{inner}": each for inner, each in flat(value).items()}
        else:
            result[key] = value
    return result


def toml_value(value: Any) -> str:
    """Write a value as TOML on one line.

    Examples
    --------
    >>> toml_value({"distribution": "uniform", "min": "1 um"}), toml_value([1, 0.5, True])
    ('{distribution = "uniform", min = "1 um"}', '[1, 0.5, true]')
    """
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            escaped = value.replace("\\", "\\\\").replace('"', '\\"')
            return f'"{escaped}"'
        case dict():
            return "{" + ", ".join(f"{key} = {toml_value(each)}" for key, each in value.items()) + "}"
        case list() | tuple():
            return "[" + ", ".join(map(toml_value, value)) + "]"
    return str(value)


def _flattened(value: Any) -> Any:
    return flat(value) if isinstance(value, dict) else value


class Reference(BaseModel):
    """What somebody else found, for the plot."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    label: str = Field(description="Who found it, for the legend.")
    at: Any = Field(description="Value of the first swept key.")
    values: dict[str, float] = Field(description='What was found: "mat.solidity in %" = 9.5, as `measure` has it.')


class Study(BaseModel):
    """One case run many times, and what is told of it."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    case: Path = Field(description="The case file that is varied; a relative path starts from the study file.")
    set_: Annotated[dict[str, Any], BeforeValidator(_flattened)] = Field(
        default_factory=dict,
        alias="set",
        description="Keys that all runs share instead of the case's own. A table for a key that takes one is "
        'written with the key in quotes: "mat.fiber_diameter" = {distribution = ...}.',
    )
    sweep: Annotated[dict[str, list[Any]], BeforeValidator(_flattened)] = Field(
        description="Keys of the case, each with the list of its values. The first is the plot's axis."
    )
    combine: Literal["grid", "pairs"] = Field(
        default="grid", description='"grid": every value with every other; "pairs": the first ones, the second ones...'
    )
    seeds: Annotated[int, Field(ge=1, le=100_000)] = Field(
        default=10, description="How many mats of each combination are run, each with a seed of its own."
    )
    first_seed: Annotated[int, Field(ge=0)] = Field(default=1, description="The first of these seeds.")
    until: str = Field(default="mat", description="The last stage that is run.")
    measure: tuple[str, ...] = Field(
        description='What is told: "STAGE.NAME" or "predict.NAME", with "in UNIT" for another unit than SI.'
    )
    keep: Literal["numbers", "everything"] = Field(
        default="numbers", description="Whether the meshes and mats of each run are kept beside its numbers."
    )
    picture: Literal["side", "top"] | None = Field(
        default=None, description="Draw the mat of each combination, with the first seed, from this side."
    )

    reference: tuple[Reference, ...] = Field(
        default=(), description="What somebody else found, drawn into the plot as crosses."
    )

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What is measured, read."""
        return tuple(map(read_quantity, self.measure))

    @model_validator(mode="after")
    def _in_itself_right(self) -> Self:
        mistakes = [*self._sweep_mistakes(), *self._measure_mistakes()]
        if mistakes:
            raise ValueError("\n".join(mistakes))
        return self

    def _sweep_mistakes(self) -> Iterator[str]:
        if not self.sweep:
            yield "sweep: names no key; add one, like mat.relaxation_slope = [0.05, 0.1]"
        for key, values in self.sweep.items():
            if not values:
                yield f"sweep.{key}: the list is empty"
            if key in self.set_:
                yield f"sweep.{key}: is set to {self.set_[key]!r} as well; leave one of them out"
        if "mat.seed" in self.sweep or "mat.seed" in self.set_:
            yield "mat.seed: is counted up from first_seed; set seeds and first_seed instead"
        lengths = {key: len(values) for key, values in self.sweep.items()}
        if self.combine == "pairs" and len(set(lengths.values())) > 1:
            yield f'sweep: combine = "pairs" takes lists of one length, not {lengths}'

    def _measure_mistakes(self) -> Iterator[str]:
        if self.until not in STAGES:
            yield f"until = {self.until!r}: the stages are {', '.join(STAGES)}"
            return
        there = (*STAGES[: STAGES.index(self.until) + 1], PREDICTED)
        if not self.measure:
            yield 'measure: names nothing; add something, like "mat.solidity in %"'
        for text in self.measure:
            try:
                first = read_quantity(text).path[0]
            except ValueError as problem:
                yield f"measure {text!r}: {problem}"
                continue
            if first in STAGES and first not in there:
                yield f'measure {text!r}: until = "{self.until}" ends before the stage {first}'
            elif first not in there:
                near = difflib.get_close_matches(first, there, n=1)
                advice = f"did you mean {near[0]}?" if near else f"it starts with one of {', '.join(there)}"
                yield f"measure {text!r}: {advice}"

        for reference in self.reference:
            for text in sorted(set(reference.values) - set(self.measure)):
                yield f"reference {reference.label!r}: {text!r} is not in measure"

    def points(self) -> list[dict[str, Any]]:
        """Give each combination of the swept keys' values."""
        combined = itertools.product(*self.sweep.values()) if self.combine == "grid" else zip(*self.sweep.values())  # noqa: B905
        return [dict(zip(self.sweep, values, strict=True)) for values in combined]

    def settings(self, point: dict[str, Any]) -> tuple[str, ...]:
        """Give the overrides of a combination, as ``fibertwin run --set`` takes them."""
        return tuple(f"{key}={toml_value(value)}" for key, value in {**self.set_, **point}.items())


def read_study(path: Path) -> Study:
    """Read a study file.

    Raises
    ------
    CaseError
        If the file cannot be read or is wrong in itself; the message has one line per mistake.
    """
    content = read_toml(path)
    try:
        study = Study.model_validate(content)
    except ValidationError as problem:
        lines = [line for error in problem.errors(include_url=False) for line in _lines(error)]
        count = f"{len(lines)} mistakes" if len(lines) > 1 else "a mistake"
        raise CaseError(f"{path} has {count}:\n" + "\n".join(f"  {line}" for line in lines)) from None
    return study.model_copy(update={"case": path.parent / study.case})


def _lines(error: Any) -> list[str]:
    place = ".".join(map(str, error["loc"]))
    message = str(error["msg"]).removeprefix("Value error, ")
    match error["type"]:
        case "extra_forbidden":
            known = sorted(field.alias or name for name, field in Study.model_fields.items())
            near = difflib.get_close_matches(place, known, n=1)
            return [f"{place}: unknown key; " + (f"did you mean {near[0]}?" if near else f"known: {', '.join(known)}")]
        case "missing":
            return [f"{place}: missing; add it"]
        case "value_error":
            return message.splitlines()
    return [f"{place} = {error['input']!r}: {message[:1].lower()}{message[1:]}"]
