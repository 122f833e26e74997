# SPDX-License-Identifier: GPL-3.0-or-later

import pytest

from pipeline.design.targets import read_targets
from pipeline.errors import CaseError


def test_targets_are_read_in_si() -> None:
    thickness, drop = read_targets(["thickness=50 um", "pressure_drop = 320 Pa"])
    assert (thickness.quantity, thickness.value) == ("thickness", 5e-5)
    assert (drop.quantity, drop.value) == ("pressure_drop", 320.0)


def test_a_bare_solidity_and_a_percentage_are_the_same() -> None:
    assert read_targets(["solidity=0.08"]) == read_targets(["solidity=8 %"])


def test_every_mistake_is_told_at_once() -> None:
    texts = ["solidty=0.08", "thickness=50", "efficiency=120 %", "coverage=2", "coverage=3", "pressure_drop"]
    with pytest.raises(CaseError) as caught:
        read_targets(texts)
    lines = str(caught.value).splitlines()
    expected = ["did you mean solidity", "number with a unit", "less than 1", "given twice", "write one of"]
    assert len(lines) == len(expected)
    for line, part in zip(lines, expected, strict=True):
        assert part in line


def test_no_target_is_refused_with_an_example() -> None:
    with pytest.raises(CaseError, match="give at least one target"):
        read_targets([])


def test_a_third_target_is_refused_because_it_follows_from_the_others() -> None:
    with pytest.raises(CaseError, match="cannot be met all at once"):
        read_targets(["solidity=0.08", "thickness=50 um", "coverage=4"])
