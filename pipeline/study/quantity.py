"""What a study tells of each run: a number in the results of a stage, or one that the models predict."""

# SPDX-License-Identifier: GPL-3.0-or-later

import difflib
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.errors import CaseError
from pipeline.line import store
from pipeline.line.places import MANIFEST
from pipeline.units import parse

NO_ANSWER = "no_answer"
"""Key of the reason why the models do not hold for a mat."""

PREDICTED = "predict"
"""First word of what the analytical models say of the mat's nominal solidity; other first words are stages."""

_SI_UNITS = ("", "m", "Pa", "s", "m/s", "byte", "kg/m^3", "Pa*s", "m^2", "m^3", "1/Pa", "kelvin", "degree", "N")

Results = dict[str, Any]
"""Numbers of a finished run: for each stage its counts, its seconds, and all that its JSON files hold."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number in the results of a run.

    Parameters
    ----------
    path : tuple of str
        Keys that lead to it; a whole number is the place in a list.
    unit : str
        In which it is told; ``""`` for SI.
    scale : float
        What its SI value is multiplied with.
    """

    path: tuple[str, ...]
    unit: str = ""
    scale: float = 1.0

    @property
    def name(self) -> str:
        """The path as people write it."""
        return ".".join(self.path)

    @property
    def label(self) -> str:
        """Name and unit, for a column or an axis."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def read_quantity(text: str) -> Quantity:
    """Read ``PATH`` or ``PATH in UNIT``.

    Raises
    ------
    ValueError
        If the unit is none.

    Examples
    --------
    >>> read_quantity("mat.thickness in um")
    Quantity(path=('mat', 'thickness'), unit='um', scale=1000000.0)
    """
    path, _, unit = (part.strip() for part in text.partition(" in "))
    keys = tuple(path.split("."))
    if not all(keys) or len(keys) < 2:
        raise ValueError('write STAGE.NAME, like mat.solidity, or STAGE.NAME in UNIT, like "mat.thickness in um"')
    return Quantity(keys, unit, _per_si(unit)) if unit else Quantity(keys)


def _per_si(unit: str) -> float:
    for si in _SI_UNITS:
        try:
            return float(f"{1.0 / parse(f'1 {unit}', si):.15g}")
        except ValueError:
            continue
    raise ValueError(f"{unit!r} is no unit that is known here; write um, %, Pa, s...")


def value_of(quantity: Quantity, results: Results) -> float:
    """Find a quantity in a run's results, in its own unit; NaN where a model had no answer.

    Raises
    ------
    CaseError
        If there is none of that name, or it is no number; the message has the names that are there.
    """
    place: Any = results
    for depth, key in enumerate(quantity.path):
        here = ".".join(quantity.path[:depth])
        table = _table(place)
        if NO_ANSWER in table:
            return math.nan
        if key not in table:
            near = difflib.get_close_matches(key, table, n=1)
            advice = f"did you mean {near[0]}?" if near else f"there are {', '.join(table) or 'no parts'}"
            raise CaseError(f"measure {quantity.name!r}: {here} has no {key}; {advice}")
        place = table[key]
    if place is None:
        return math.nan
    if not isinstance(place, int | float):
        kind = f"a table of {', '.join(place)}" if isinstance(place, dict) else repr(place)[:60]
        raise CaseError(f"measure {quantity.name!r} is no number but {kind}")
    return quantity.scale * place


def _table(place: Any) -> dict[str, Any]:
    if isinstance(place, list):
        return {str(number): each for number, each in enumerate(place)}
    return place if isinstance(place, dict) else {}


def stage_results(folder: Path) -> Results:
    """Gather the numbers of a finished stage's folder."""
    manifest = store.read_json(folder / MANIFEST)
    results: Results = {**manifest["counts"], "seconds": manifest["seconds"]}
    for path in sorted(folder.glob("*.json")):
        if path.name != MANIFEST:
            results |= store.read_json(path)
    return results
