"""Settings of a mat as lines of a case file."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from pipeline.units import written

_UNITS = dict.fromkeys(("diameter", "mean", "std", "median", "min", "max"), "m") | {"axis": "degree"}
"""Of the settings of diameters and directions; what is not named is a plain ratio."""


def table_lines(settings: BaseModel) -> list[str]:
    """Write a table of diameters or of directions, key by key.

    Parameters
    ----------
    settings : settings of a distribution of diameters or of a law of directions

    Returns
    -------
    list of str
        Numbers have four digits.

    Examples
    --------
    >>> from pipeline.mat.settings import Lognormal
    >>> table_lines(Lognormal(median=1.2e-6, geometric_std=1.5))
    ['distribution = "lognormal"', 'median = "1.2 um"', 'geometric_std = 1.5']
    """
    content = settings.model_dump(exclude_none=True)
    # the key that says what kind of table this is comes first
    ordered = sorted(content, key=lambda key: key not in ("distribution", "law"))
    return [f"{key} = {_value(key, content[key])}" for key in ordered]


def _value(key: str, value: Any) -> str:
    if isinstance(value, Mapping):
        ordered = sorted(value, key=lambda inner: inner != "distribution")
        return "{ " + ", ".join(f"{inner} = {_value(inner, value[inner])}" for inner in ordered) + " }"
    if isinstance(value, (list, tuple)):
        return "[\n" + "".join(f"    {_value('', each)},\n" for each in value) + "]"
    if isinstance(value, str):
        return f'"{value}"'
    number = float(f"{value:.4g}")
    return f'"{written(number, _UNITS[key])}"' if key in _UNITS else f"{number:g}"
