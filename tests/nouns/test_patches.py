"""A patch is one noun, and the order of the patches in files is the one that solvers have seen so far."""

# SPDX-License-Identifier: GPL-3.0-or-later

import pytest

from pipeline.nouns.patches import BY_NAME, DUCT, FIBERS, PATCHES, SIDES


def test_the_names_and_their_order_stay_as_written_cases_have_them() -> None:
    assert PATCHES == ("inlet", "outlet", "xmin", "xmax", "ymin", "ymax", "fibers")
    assert SIDES == ("xmin", "xmax", "ymin", "ymax")


def test_opposite_patches_are_opposite_both_ways() -> None:
    for patch in DUCT:
        if patch.axis is not None:
            assert patch.opposite.opposite is patch
            assert patch.opposite.axis == patch.axis
            assert patch.opposite.end != patch.end
    with pytest.raises(LookupError, match="opposite to fibers"):
        _ = BY_NAME[FIBERS].opposite
