"""The case file: TOML in, valid settings out, every mistake told at once."""

# SPDX-License-Identifier: GPL-3.0-or-later

import difflib
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model

from pipeline.errors import CaseError
from pipeline.line.stages import LINE, SHARED
from pipeline.mat.settings import STOPS, FileSettings, SurfaceFileSettings
from pipeline.reading import read_bytes
from pipeline.units import FROM_FILE

LARGEST_FILE = 100_000
"""No case file is larger than this many bytes: a larger one is something else."""

DEEPEST = 20
"""No case file nests more tables than this into each other; what walks through them may be recursive."""
LARGEST_INTEGER = 2**63 - 1
"""TOML's integers have 64 bits."""
# a name of more parts than tables may nest; a part starts where no name goes on, or the search takes a square too
_PART = r"(?:[A-Za-z0-9_-]++|\"[^\"\n]*+\"|'[^'\n]*+')"
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{DEEPEST},}}")
_SYNONYMS = {
    "gsd": "geometric_std",
    "sigma_g": "geometric_std",
    "sigma": "std",
    "velocity": "face_velocity",
    "u0": "face_velocity",
    "packing_density": "solidity",
    "alpha": "solidity",
    "slope": "relaxation_slope",
    "d": "fiber_diameter",
}
"""What else the field calls a key."""
_MOST_MISTAKES, _LONGEST_LINE = 20, 400

_Settings = TypeVar("_Settings", bound=BaseModel)


class CaseTables(BaseModel):
    """One case: a table of settings per stage, in SI once read.

    The tables follow from what the stages say of themselves (`pipeline.line.stages`).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    if TYPE_CHECKING:

        def __init__(self, **tables: Any) -> None: ...

        def __getattr__(self, table: str) -> Any: ...

    @property
    def asked(self) -> frozenset[str]:
        """Stages that run only where they are asked for, and that the case file asks for by having their table."""
        return frozenset(stage.name for stage in LINE if stage.asked and stage.name in self.model_fields_set)

    def content(self) -> dict[str, Any]:
        """Give the whole case as a JSON-able thing, every setting in SI; it makes the same case again."""
        unasked = {stage.name for stage in LINE if stage.asked} - self.asked
        return self.model_dump(mode="json", exclude=unasked)


def _table(settings: Any, about: str, required: bool = False) -> Any:
    return settings, Field(description=about) if required else Field(default_factory=settings, description=about)


if TYPE_CHECKING:
    Case = CaseTables
else:
    Case = create_model(
        "Case",
        __base__=CaseTables,
        __doc__=CaseTables.__doc__,
        **{
            stage.name: _table(stage.settings, stage.about, stage.required)
            for stage in LINE
            if stage.settings is not None
        },
        **{name: _table(settings, about) for name, (settings, about) in SHARED.items()},
    )


def read_case(path: Path, overrides: tuple[str, ...] = ()) -> Case:
    """Read a case file and apply overrides like ``mat.seed=7``.

    Raises
    ------
    CaseError
        If the file cannot be read, is no TOML, or asks for nonsense; the message has one line per mistake.
    """
    case = validate(override(read_toml(path), overrides), str(path))
    if isinstance(case.mat, FileSettings | SurfaceFileSettings):
        case = _beside(case, "mat", path.parent)
    return _beside(case, "micrograph", path.parent) if case.micrograph.file is not None else case


def _beside(case: Case, table: str, folder: Path) -> Case:
    """Let the path in a table start from the case file, wherever the command is run."""
    settings = getattr(case, table)
    return case.model_copy(update={table: settings.model_copy(update={"file": folder / settings.file})})


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file as nested dictionaries.

    Raises
    ------
    CaseError
        If the file cannot be read or is no TOML.
    """
    try:
        text = read_bytes(path, LARGEST_FILE).decode("utf-8")
        _refuse_long_keys(text, str(path))
        return _sound(tomllib.loads(text), str(path))
    except OSError as problem:
        raise CaseError(f"cannot read the case file {path}: {problem.strerror}") from problem
    except UnicodeDecodeError as problem:
        raise CaseError(f"{path} is not a text file in UTF-8: {problem.reason} at byte {problem.start}") from problem
    except (ValueError, RecursionError) as problem:
        # a ValueError beside TOML's own: an integer of thousands of digits
        raise CaseError(f"{path} is not valid TOML: {problem}") from problem


def _refuse_long_keys(text: str, source: str) -> None:
    # before the parser, which takes the square of their length
    found = _LONG_KEY.search(text)
    if found is not None:
        line = text.count("\n", 0, found.start()) + 1
        raise CaseError(f"{source}, line {line}, nests tables more than {DEEPEST} deep; a case file needs 5")


def _sound(content: dict[str, Any], source: str) -> dict[str, Any]:
    """Refuse what no case needs and what libraries stumble over: deep nesting, integers of hundreds of digits."""
    level: list[Any] = [content]
    for _ in range(DEEPEST):
        inner = [each for outer in level for each in (outer.values() if isinstance(outer, dict) else outer)]
        if any(isinstance(each, int) and abs(each) > LARGEST_INTEGER for each in inner):
            raise CaseError(f"{source} has an integer of more than {len(str(LARGEST_INTEGER))} digits; TOML has none")
        level = [each for each in inner if isinstance(each, dict | list)]
    if level:
        raise CaseError(f"{source} nests tables or lists more than {DEEPEST} deep; a case file needs 5")
    return content


def override(content: dict[str, Any], overrides: tuple[str, ...]) -> dict[str, Any]:
    """Give a copy of the case's content with each ``table.key=value`` put in.

    A value is read as TOML where it is TOML, and as text otherwise, so that ``mat.side=20 um`` needs no quotes.
    Setting one key of ``mat.stop`` replaces the stop, since there is only one.

    Raises
    ------
    CaseError
        If an override is not of the form ``table.key=value``.

    Examples
    --------
    >>> override({"mat": {"seed": 1}}, ("mat.seed=7", "mat.side=20 um"))
    {'mat': {'seed': 7, 'side': '20 um'}}
    """
    result = _copy(content)
    for text in overrides:
        path, equals, value = text.partition("=")
        keys = path.strip().split(".")
        if not equals or not all(keys) or len(keys) > DEEPEST:
            raise CaseError(f"--set {text!r}: write table.key=value, like --set mat.seed=7")
        table = result
        for depth, key in enumerate(keys[:-1]):
            table = table.setdefault(key, {})
            if not isinstance(table, dict):
                raise CaseError(f"--set {text!r}: {'.'.join(keys[: depth + 1])} is a value, not a table")
        if keys[:-1] == ["mat", "stop"] and keys[-1] in STOPS:
            for other in STOPS:
                table.pop(other, None)
        table[keys[-1]] = _toml_value(value.strip())
    return result


def _copy(content: dict[str, Any]) -> dict[str, Any]:
    return {key: _copy(value) if isinstance(value, dict) else value for key, value in content.items()}


def _toml_value(text: str) -> Any:
    try:
        _refuse_long_keys(text, "--set")
        return _sound(tomllib.loads(f"value = {text}"), "--set")["value"]
    except (ValueError, RecursionError):
        return text


def validate(content: dict[str, Any], source: str) -> Case:
    """Make a case of a file's content.

    Raises
    ------
    CaseError
        With one line per mistake: its path, what is wrong, and what would do.
    """
    return validate_as(Case, content, source)


def validate_as(kind: type[_Settings], content: dict[str, Any], source: str) -> _Settings:
    """Make settings with the tables of a case, or some of them, of what a person wrote.

    Raises
    ------
    CaseError
        As `validate`.
    """
    try:
        return kind.model_validate(content, context=FROM_FILE)
    except ValidationError as problem:
        errors = problem.errors(include_url=False)
        lines = [_shortened(_line(error, content, kind)) for error in errors[:_MOST_MISTAKES]]
        if len(errors) > _MOST_MISTAKES:
            lines.append(f"and {len(errors) - _MOST_MISTAKES} more")
        count = f"{len(errors)} mistakes" if len(errors) > 1 else "a mistake"
        raise CaseError(f"{source} has {count}:\n" + "\n".join(f"  {line}" for line in lines)) from None


def _shortened(line: str) -> str:
    # a message quotes what was written, which may be a novel
    return line if len(line) <= _LONGEST_LINE else f"{line[:_LONGEST_LINE]} ..."


def _line(error: Any, content: dict[str, Any], kind: type[BaseModel]) -> str:
    keys = [str(key) for key in error["loc"]]
    place = ".".join(keys) or ("the case" if kind is Case else "all of it")
    message = str(error["msg"]).removeprefix("Value error, ")
    value = error.get("input")
    match error["type"]:
        case "extra_forbidden":
            known = _known(keys[:-1], kind)
            if keys[-1] in known:
                return f"{place}: does not go with {_kind_of(keys[:-1], content)}; leave it out"
            moved = [table for table in known if keys[-1] in _known([*keys[:-1], table], kind)]
            if moved:
                places = " or ".join(".".join([*keys[:-1], table, keys[-1]]) for table in moved)
                return f"{place}: no key of [{'.'.join(keys[:-1])}]; write {places}"
            # what the field calls a key comes before what merely looks like it
            near = [name for name in (_SYNONYMS.get(keys[-1].lower()),) if name in known]
            near = near or difflib.get_close_matches(keys[-1], known, n=1)
            advice = f"did you mean {near[0]}?" if near else f"known: {', '.join(known) or 'none'}"
            return f"{place}: unknown key; {advice}"
        case "missing":
            return f"{place}: missing; add it"
        case "value_error" | "assertion_error":
            return f"{place}: {message}"
    return f"{place} = {value!r}: {message[:1].lower()}{message[1:]}"


def _kind_of(tables: list[str], content: dict[str, Any]) -> str:
    table: Any = content
    for key in tables:
        table = table.get(key, {}) if isinstance(table, dict) else {}
    for tag in ("generator", "distribution", "law"):
        if isinstance(table, dict) and tag in table:
            return f"{'.'.join([*tables, tag])} = {table[tag]!r}"
    return f"the other keys of {'.'.join(tables) or 'the case'}"


def _known(tables: list[str], kind: type[BaseModel]) -> list[str]:
    schema = _schema(kind)
    found = [schema]
    for table in tables:
        found = [branch for part in found for branch in _branches(part.get("properties", {}).get(table, {}), schema)]
    return sorted({name for part in found for name in part.get("properties", {})})


@cache
def _schema(kind: type[BaseModel]) -> dict[str, Any]:
    return kind.model_json_schema()


def _branches(part: dict[str, Any], schema: dict[str, Any]) -> list[dict[str, Any]]:
    if "$ref" in part:
        return _branches(schema["$defs"][part["$ref"].rsplit("/", 1)[-1]], schema)
    nested = [*part.get("anyOf", []), *part.get("oneOf", []), *part.get("allOf", [])]
    return [part, *(branch for option in nested for branch in _branches(option, schema))]
