"""What a person types to predict a filter, turned into settings: one table of text, all mistakes told at once."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Mapping

from pydantic import ValidationError

from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.errors import CaseError
from pipeline.units import FROM_FILE

_UNITS = {"solidity": "", "thickness": "m", "fiber_diameter": "m"}


def read_options(
    given: Mapping[str, str], medium: FilterSettings | None = None, flow: FlowSettings | None = None
) -> tuple[FilterSettings, FlowSettings]:
    """Read a filter and its flow from text with units, over those of a case or run where there is one.

    Parameters
    ----------
    given : mapping of str to str
        Fields of `FilterSettings` and `FlowSettings`, such as ``{"solidity": "9.48 %", "face_velocity": "2.5 cm/s"}``.
    medium : FilterSettings, optional
        The filter that `given` changes; without one, all three of its fields must be given.
    flow : FlowSettings, optional
        The flow that `given` changes; without one, its defaults.

    Returns
    -------
    medium : FilterSettings
    flow : FlowSettings

    Raises
    ------
    CaseError
        If something is missing, unknown, or no such quantity: one line each, named as the command's options are.

    Examples
    --------
    >>> typed = {"solidity": "5 %", "thickness": "1 mm", "fiber_diameter": "2 um", "preset": "hinds"}
    >>> medium, flow = read_options(typed)
    >>> medium.thickness, flow.preset
    (0.001, 'hinds')
    """
    _ask_for_percent(given.get("solidity"))
    known = medium.model_dump() if medium else {}
    of_medium = {name: f"{value!r} {_UNITS[name]}".strip() for name, value in known.items()}
    of_medium |= {name: text for name, text in given.items() if name in _UNITS}
    of_flow = {name: text for name, text in given.items() if name not in _UNITS}
    mistakes: list[str] = []
    read_medium, read_flow = None, None
    try:
        read_medium = FilterSettings.model_validate(of_medium, context=FROM_FILE)
    except ValidationError as problem:
        mistakes += _lines(problem)
    try:
        read_flow = FlowSettings.model_validate(of_flow, context=FROM_FILE)
    except ValidationError as problem:
        mistakes += _lines(problem)
    if read_medium is None or read_flow is None:
        raise CaseError("\n".join(mistakes))
    if flow is not None:
        changed = {**flow.model_dump(), **{name: getattr(read_flow, name) for name in of_flow}}
        try:
            read_flow = FlowSettings.model_validate(changed)
        except ValidationError as problem:
            # each value is fine, together they are not
            raise CaseError("\n".join(_lines(problem))) from None
    return read_medium, read_flow


def _ask_for_percent(text: str | None) -> None:
    """Refuse a solidity that can only be a percentage, and say how it is written."""
    try:
        value = float(text or "")
    except ValueError:
        return
    if 1.0 < value < 100.0:
        raise CaseError(f'--solidity {text}: no medium is more than solid; was {text} % meant? Write "{text} %"')


def _lines(problem: ValidationError) -> list[str]:
    lines = []
    for error in problem.errors(include_url=False):
        option = "--" + "-".join(str(part) for part in error["loc"][:1]).replace("_", "-")
        if not error["loc"]:
            lines.append(error["msg"].removeprefix("Value error, "))
        elif error["type"] == "missing":
            lines.append(f"{option} is missing; give it, or a case or run that has it")
        elif error["type"] == "extra_forbidden":
            lines.append(f"{option}: there is no such option")
        else:
            lines.append(f"{option} {error['input']}: {error['msg'].removeprefix('Value error, ')}")
    return lines
