"""The exact drag of arrays, against what others found by other methods."""

# SPDX-License-Identifier: GPL-3.0-or-later

import pytest

from validation.exact import hexagonal_drag, square_drag


@pytest.mark.parametrize(("solidity", "drag"), [(0.05, 15.5578), (0.10, 24.8317), (0.20, 51.5269), (0.30, 102.881)])
def test_square_arrays_have_the_drag_that_sangani_and_acrivos_found(solidity: float, drag: float) -> None:
    # all the six digits they print (Int. J. Multiphase Flow 8, 193, 1982)
    assert square_drag(solidity) == pytest.approx(drag, rel=4e-6)


def test_slip_lowers_the_drag_as_the_cell_model_says_where_fibers_are_far_apart() -> None:
    # Kuwabara's cell with slip, its ratio to no slip: at solidity 0.01 an array is round enough for a percent
    from pipeline.analytics.formulas.slip import kuwabara_slip

    for drag in (square_drag, hexagonal_drag):
        ratio = drag(0.01, 0.1) / drag(0.01)
        assert ratio == pytest.approx(float(kuwabara_slip(0.01, 0.1) / kuwabara_slip(0.01, 0.0)), rel=0.01)
