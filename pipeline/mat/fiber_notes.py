"""What the comment lines of a file of fibers state about its slab."""

# SPDX-License-Identifier: GPL-3.0-or-later

import difflib
import re
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.cad.lengths import NUMBER, in_meters, unit_of
from pipeline.errors import CaseError

_NOTE = re.compile(r"#\s*(?P<key>\w+)\s*[:=]\s*(?P<value>.*?)\s*")
_PLAN = re.compile(rf"({NUMBER})\s*([^\W\d]*)\s*[x×*]\s*({NUMBER})\s*([^\W\d]+)", re.IGNORECASE)
_LENGTH = re.compile(rf"({NUMBER})\s*([^\W\d]+)")
_EXAMPLES = {"plan": "100 um x 100 um", "thickness": "46.4 um", "periodic": "yes"}
_PERIODIC = {"yes": True, "true": True, "no": False, "false": False}


@dataclass
class Notes:
    """The slab as the file states it [m]; None where it is silent."""

    plan: tuple[float, float] | None = None
    thickness: float | None = None
    periodic: bool | None = None
    lines: dict[str, int] = field(default_factory=dict)

    def read(self, comment: str, path: Path, number: int) -> None:
        """Read a comment line, which may be a remark about anything.

        Raises
        ------
        CaseError
            If the line states something twice, or in words that do not say it.
        """
        note = _NOTE.fullmatch(comment)
        if note is None:
            return
        key, value = note["key"].lower(), note["value"]
        if key not in _EXAMPLES:
            near = difflib.get_close_matches(key, _EXAMPLES, n=1, cutoff=0.8)
            if near:
                raise CaseError(f"{path}, line {number}: # {note['key']}: states nothing; did you mean # {near[0]}: ?")
            return
        if key in self.lines:
            raise CaseError(f"{path}, line {number}: # {key}: is stated again, first on line {self.lines[key]}")
        self.lines[key] = number
        try:
            self._take(key, value)
        except (ValueError, KeyError):
            raise CaseError(
                f"{path}, line {number}: write # {key}: {_EXAMPLES[key]}, not {_shortened(value)!r}"
            ) from None

    def _take(self, key: str, value: str) -> None:
        if key == "periodic":
            self.periodic = _PERIODIC[value.lower()]
            return
        match = (_PLAN if key == "plan" else _LENGTH).fullmatch(value)
        if match is None:
            raise ValueError(value)
        if key == "thickness":
            self.thickness = in_meters(match[1], unit_of(match[2]))
        else:
            self.plan = (in_meters(match[1], unit_of(match[2] or match[4])), in_meters(match[3], unit_of(match[4])))


def _shortened(value: str) -> str:
    return value if len(value) <= 80 else f"{value[:80]} ..."
