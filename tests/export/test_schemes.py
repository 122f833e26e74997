"""The schemes beside cyclic patches and elsewhere."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.export.formats.openfoam.dictionaries import format_fv_schemes


def test_least_squares_and_the_full_correction_are_left_out_beside_cyclic_patches() -> None:
    # OpenFOAM v1912 stops at the one there, and with the gradients from the points diverges at the other
    assert "pointCellsLeastSquares" in format_fv_schemes()
    assert "corrected" in format_fv_schemes()
    assert "LeastSquares" not in format_fv_schemes(cyclic=True)
    assert "corrected" not in format_fv_schemes(cyclic=True)


def test_the_pressure_keeps_its_gradient_and_its_limit_either_way() -> None:
    for cyclic in (False, True):
        text = format_fv_schemes(cyclic)
        assert "default         Gauss pointLinear;" in text
        assert "default         Gauss linear limited 0.333;" in text
        assert text.count("{") == text.count("}")
