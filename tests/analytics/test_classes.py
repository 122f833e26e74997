"""Classes of filters against the standards' own limits."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.analytics.formulas.classes import (
    EN_1822,
    ISO_29463,
    RURAL,
    en_1822_class,
    iso_16890_group,
    iso_29463_class,
    particulate_efficiency,
)


def test_a_filter_at_a_limit_is_in_its_class_and_one_beyond_is_not() -> None:
    for table, named in ((EN_1822, en_1822_class), (ISO_29463, iso_29463_class)):
        assert [limit for _, limit in table] == sorted(limit for _, limit in table)
        for name, limit in table:
            assert named(limit) == name
            assert named(limit * 1.01) != name
    # 99.95 % written as a share
    assert en_1822_class(1 - 0.9995) == "H13"
    assert iso_29463_class(0.2) is None


def test_both_standards_agree_where_they_name_the_same_limit() -> None:
    # ISO 29463-1 took over EN 1822's limits of E11 to U17
    limits = dict(ISO_29463)
    assert {limit for name, limit in EN_1822 if name != "E10"} <= set(limits.values())


def test_the_standard_air_has_the_volume_that_the_standard_prints() -> None:
    # ISO 16890-1:2016, Table 4: the rural share at the geometric mean of .3 and .4 um
    assert RURAL.volume(np.array([np.sqrt(0.3e-6 * 0.4e-6)]))[0] == pytest.approx(0.09412, abs=2e-5)


def test_half_the_efficiency_is_half_in_every_group_and_too_few_sizes_give_none() -> None:
    sizes = np.array([1e-7, 1e-6, 1e-5])
    for group in ("ePM1", "ePM2.5", "ePM10"):
        assert particulate_efficiency(sizes, np.full(3, 0.5), group) == pytest.approx(0.5)
    assert particulate_efficiency(sizes[:2], np.full(2, 0.5), "ePM2.5") is None
    # coarse dust counts by volume: what catches only large particles does better in ePM10
    rising = np.array([0.0, 0.2, 1.0])
    values = [particulate_efficiency(sizes, rising, group) for group in ("ePM1", "ePM2.5", "ePM10")]
    assert values == sorted(values, key=lambda value: value or 0.0)


def test_a_filter_is_named_by_the_finest_group_that_it_catches_half_of() -> None:
    assert iso_16890_group({"ePM1": 0.62, "ePM2.5": 0.7, "ePM10": 0.9}) == "ISO ePM1 60%"
    assert iso_16890_group({"ePM1": 0.97, "ePM2.5": 1.0, "ePM10": 1.0}) == "ISO ePM1 >95%"
    assert iso_16890_group({"ePM1": 0.1, "ePM2.5": 0.2, "ePM10": 0.3}) == "ISO Coarse"
    assert iso_16890_group({"ePM1": 0.1, "ePM2.5": None, "ePM10": None}) is None
