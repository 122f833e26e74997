"""Every pressure-drop model against exact arrays, its dilute limit, and the laws it must obey."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import k1, kv, kvp

from pipeline.analytics.formulas import pressure_drop as formulas
from pipeline.analytics.formulas import slip, spielman_goren
from pipeline.analytics.models.pressure_models import MODELS, pressure_model
from pipeline.errors import CaseError
from validation.exact import hexagonal_drag, square_drag

EULER = 0.5772156649015329


def drag(coefficient: object, solidity: float) -> float:
    """F*, as the exact solutions give it."""
    return math.pi * float(np.asarray(coefficient)) / (4 * solidity)


@pytest.mark.parametrize(
    ("solidity", "published"), [(0.05, 15.5578), (0.10, 24.8317), (0.20, 51.5269), (0.30, 102.881)]
)
def test_our_exact_square_array_is_sangani_and_acrivos(solidity: float, published: float) -> None:
    # the judge is judged first: all six printed digits (Sangani and Acrivos 1982)
    assert square_drag(solidity) == pytest.approx(published, rel=4e-6)


def test_our_exact_square_array_holds_with_slip() -> None:
    assert square_drag(0.1, slip_length=0.1) == pytest.approx(21.8735, abs=1e-4)


# what method.md states of each series, and half as much again of the next digit
@pytest.mark.parametrize(
    ("solidity", "error"), [(0.01, 1e-4), (0.05, 1e-4), (0.1, 1e-4), (0.2, 0.00155), (0.3, 0.0235)]
)
def test_the_square_series_keeps_its_stated_error(solidity: float, error: float) -> None:
    series = drag(formulas.drummond_tahir_square(solidity), solidity)
    assert series == pytest.approx(square_drag(solidity), rel=error)


@pytest.mark.parametrize(("solidity", "error"), [(0.01, 2e-4), (0.1, 6e-4), (0.2, 0.0011), (0.3, 0.00305)])
def test_the_hexagonal_series_keeps_its_stated_error(solidity: float, error: float) -> None:
    series = drag(formulas.drummond_tahir_hexagonal(solidity), solidity)
    assert series == pytest.approx(hexagonal_drag(solidity), rel=error)


def test_the_series_are_off_by_what_is_stated_of_them_no_less() -> None:
    # 2.3 % over and .3 % under at 0.3: a wrong last coefficient would as likely bring them nearer
    square = drag(formulas.drummond_tahir_square(0.3), 0.3) / square_drag(0.3) - 1
    hexagonal = drag(formulas.drummond_tahir_hexagonal(0.3), 0.3) / hexagonal_drag(0.3) - 1
    assert square == pytest.approx(0.023, abs=5e-4)
    assert hexagonal == pytest.approx(-0.003, abs=5e-5)


@pytest.mark.parametrize("solidity", [0.001, 0.01, 0.05, 0.1, 0.2, 0.3])
def test_kuwabaras_cell_is_the_hexagonal_array_within_its_stated_half_percent(solidity: float) -> None:
    assert drag(formulas.kuwabara(solidity), solidity) == pytest.approx(hexagonal_drag(solidity), rel=0.004)


@pytest.mark.parametrize("slip_length", [0.01, 0.1, 0.25])
@pytest.mark.parametrize("solidity", [0.01, 0.1, 0.2])
def test_kuwabaras_cell_with_slip_is_the_hexagonal_array_with_slip(solidity: float, slip_length: float) -> None:
    # the cell's error does not grow with slip, up to the end of the slip regime
    cell = drag(slip.kuwabara_slip(solidity, slip_length), solidity)
    assert cell == pytest.approx(hexagonal_drag(solidity, slip_length), rel=0.005)


@pytest.mark.parametrize("name", ["henry_ariman", "rao_faghri"])
def test_a_fitted_polynomial_is_within_ten_percent_in_the_range_it_claims(name: str) -> None:
    model = MODELS[name]
    for solidity in np.linspace(model.low, model.high, 9):
        assert drag(model.coefficient(solidity, 0.0), solidity) == pytest.approx(hexagonal_drag(solidity), rel=0.10)


def test_rao_and_faghri_need_the_factor_four() -> None:
    # errata: as printed, on the diameter, they are a quarter of every exact array
    for solidity, exact in ((0.05, 1.0019), (0.0948, 2.9070), (0.2, 13.025)):
        assert formulas.rao_faghri(solidity) == pytest.approx(exact, rel=0.006)


def test_happel_at_five_percent_is_point_eight() -> None:
    # errata: .800; the printed (1-a)^2/2 gives .629
    assert float(formulas.happel(0.05)) == pytest.approx(0.800, abs=5e-4)


# -- dilute limits -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "constant"),
    [("kuwabara", 1.5), ("happel", 1.0), ("drummond_tahir_square", 1.47633597), ("drummond_tahir_hexagonal", 1.497)],
)
def test_a_dilute_array_has_the_logarithm_of_all_arrays_and_a_constant_of_its_own(name: str, constant: float) -> None:
    # 8 pi / F* = -ln a - constant as a -> 0, the logarithm of Lamb's cylinder
    solidity = 1e-9
    resistance = 8 * math.pi / drag(MODELS[name].coefficient(solidity, 0.0), solidity)
    assert -math.log(solidity) - resistance == pytest.approx(constant, abs=1e-6)


def test_dilute_layers_are_lambs_cylinders_in_brinkmans_medium() -> None:
    # F* = 4 pi / (-ln(xi/2) - gamma), with xi^2 = a F*/pi (Howells 1974)
    solidity = 1e-9
    found = drag(spielman_goren.spielman_goren_layers(solidity), solidity)
    reach = math.sqrt(solidity * found / math.pi)
    assert found == pytest.approx(4 * math.pi / (-math.log(reach / 2) - EULER), rel=1e-6)


def test_the_isotropic_form_has_five_sixths_of_the_layers_in_the_dilute_limit() -> None:
    # fibers along the flow resist half as much: 2/3 + 1/3 * 1/2 = 5/6, whose inverse is Jackson and James' 3/20 : 1/8
    solidity = 1e-9
    found = drag(spielman_goren.spielman_goren_isotropic(solidity), solidity)
    reach = math.sqrt(solidity * found / math.pi)
    assert found == pytest.approx(5 / 6 * 4 * math.pi / (-math.log(reach / 2) - EULER), rel=1e-6)


def test_jackson_and_james_share_the_isotropic_logarithm() -> None:
    # the ratio of the two tends to 1 as ln ln a / ln a, so slowly that only its direction can be seen
    ratios = [
        float(spielman_goren.spielman_goren_isotropic(a)) / float(formulas.jackson_james(a))
        for a in (1e-3, 1e-6, 1e-12, 1e-30)
    ]
    assert ratios == sorted(ratios)
    assert 0.93 < ratios[-1] < 1.0


def test_slip_in_a_dilute_cell_acts_as_it_does_in_brinkmans_medium() -> None:
    # both give 4 pi / F* a shift of s / (1 + 2 s): slip is a matter of the fiber, not of its neighbours
    solidity, s = 1e-9, 0.2
    for model in (slip.kuwabara_slip, spielman_goren.spielman_goren_layers):
        with_slip, without = drag(model(solidity, s), solidity), drag(model(solidity, 0.0), solidity)
        shift = 4 * math.pi / with_slip - 4 * math.pi / without
        if model is spielman_goren.spielman_goren_layers:
            shift -= 0.5 * math.log(without / with_slip)  # the medium itself resists less
        assert shift == pytest.approx(s / (1 + 2 * s), abs=1e-5)


# -- Spielman and Goren, by a second way -----------------------------------------------------------------------


@pytest.mark.parametrize("slip_length", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("solidity", [0.001, 0.05, 0.3])
def test_layers_carry_the_pressure_that_their_far_field_tells(solidity: float, slip_length: float) -> None:
    # psi = (r + B/r + C K1(xi r)) sin(theta) about a cylinder in Brinkman's medium; the pressure far away is that of
    # a force of -2 pi xi^2 B, which must be pi xi^2 / a, the pressure gradient on the volume of one fiber
    reach = math.sqrt(float(spielman_goren.spielman_goren_layers(solidity, slip_length)) / 4)
    slope, curve = float(reach * kvp(1, reach)), float(reach**2 * kvp(1, reach, 2))
    on_wall = (1.0, float(k1(reach)))
    shear = (-1.0 - 3.0 * slip_length, (1 + slip_length) * slope - slip_length * curve)
    dipole = float(np.linalg.solve(np.array([on_wall, shear]), np.array([-1.0, -1.0 - slip_length]))[0])
    assert -2 * math.pi * reach**2 * dipole == pytest.approx(math.pi * reach**2 / solidity, rel=1e-9)


def test_the_isotropic_form_adds_up_fibers_across_and_along() -> None:
    # across: 4 pi xi^2 (1/2 + R), along: 2 pi xi^2 R with s xi K1(xi r) slipping at the wall; two to one in space
    solidity, s = 0.05, 0.2
    reach = math.sqrt(float(spielman_goren.spielman_goren_isotropic(solidity, s)) / 4)
    bessel0, bessel1 = float(kv(0, reach)), float(kv(1, reach))
    stuck = bessel1 / (reach * bessel0)
    across = 4 * math.pi * reach**2 * (0.5 + stuck * (1 + 2 * s) / (1 + 2 * s + s * reach**2 * stuck))
    along = 2 * math.pi * reach * bessel1 / (bessel0 + s * reach * bessel1)
    assert 2 / 3 * across + 1 / 3 * along == pytest.approx(math.pi * reach**2 / solidity, rel=1e-9)


# -- laws --------------------------------------------------------------------------------------------------------

in_range = st.floats(0.006, 0.29)


@given(solidity=in_range)
@pytest.mark.parametrize("name", list(MODELS))
def test_more_fiber_resists_more(name: str, solidity: float) -> None:
    coefficient = MODELS[name].coefficient
    assert float(coefficient(1.01 * solidity, 0.1)) > float(coefficient(solidity, 0.1)) > 0


@given(solidity=in_range, slip_length=st.floats(0.0, 2.0))
@pytest.mark.parametrize("name", [name for name, model in MODELS.items() if model.slips])
def test_slip_only_ever_takes_away(name: str, solidity: float, slip_length: float) -> None:
    stuck = MODELS[name.removesuffix("_slip")].coefficient(solidity, slip_length)
    slipping = MODELS[name].coefficient(solidity, slip_length)
    assert float(slipping) <= float(stuck) * (1 + 1e-9)
    assert float(MODELS[name].coefficient(solidity, 0.0)) == pytest.approx(float(stuck), rel=1e-9)


@given(
    viscosity=st.floats(1e-5, 1e-4),
    velocity=st.floats(1e-3, 1.0),
    thickness=st.floats(1e-6, 1e-2),
    diameter=st.floats(1e-7, 1e-4),
)
def test_pressure_drop_scales_and_its_diameter_comes_back(
    viscosity: float, velocity: float, thickness: float, diameter: float
) -> None:
    f = formulas.davies(0.1)
    drop = float(formulas.pressure_drop(f, viscosity, velocity, thickness, diameter))
    assert drop * diameter**2 / (viscosity * velocity * thickness) == pytest.approx(f, rel=1e-12)
    back = formulas.effective_fiber_diameter(f, viscosity, velocity, thickness, drop)
    assert float(back) == pytest.approx(diameter, rel=1e-12)


def test_a_model_takes_arrays_as_it_takes_numbers() -> None:
    solidity = np.array([0.02, 0.1, 0.2])
    for name, model in MODELS.items():
        one_by_one = [float(model.coefficient(float(a), 0.1)) for a in solidity]
        assert np.asarray(model.coefficient(solidity, 0.1)) == pytest.approx(one_by_one, rel=1e-12), name


def test_where_a_model_has_no_answer_it_says_infinity() -> None:
    assert math.isinf(float(formulas.jackson_james(0.4)))
    assert math.isinf(float(spielman_goren.spielman_goren_layers(0.5)))
    assert math.isinf(float(spielman_goren.spielman_goren_isotropic(0.75)))


def test_out_of_range_a_model_answers_and_says_so() -> None:
    davies = pressure_model("davies")
    assert davies.notes(0.1, knudsen=0.1, reynolds=0.001) == ()
    assert "outside 0.006 to 0.3" in davies.notes(0.4, 0.1, 0.001)[0]
    assert "Re 0.2 above 0.05" in davies.notes(0.1, 0.1, 0.2)[0]
    assert float(davies.coefficient(0.4, 0.0)) > 0


def test_a_slip_model_is_warned_for_beyond_slip_flow() -> None:
    assert MODELS["kuwabara_slip"].notes(0.1, 0.1, 0.001) == ()
    assert "transition" in MODELS["kuwabara_slip"].notes(0.1, 0.3, 0.001)[0]


def test_a_model_without_slip_says_how_much_too_high_it_is() -> None:
    (note,) = MODELS["kuwabara"].notes(0.1, knudsen=0.1, reynolds=0.001)
    excess = float(formulas.kuwabara(0.1)) / float(slip.kuwabara_slip(0.1, 0.0998)) - 1
    assert f"{excess:.0%}" in note
    assert MODELS["kuwabara"].notes(0.1, knudsen=0.005, reynolds=0.001) == ()


def test_an_unknown_model_is_refused_with_those_there_are() -> None:
    with pytest.raises(CaseError, match=r"'darcy'.*davies, kuwabara"):
        pressure_model("darcy")


@pytest.mark.parametrize(
    ("diameter", "regime"),
    [(14e-6, "continuum"), (12e-6, "slip"), (0.53e-6, "slip"), (0.5e-6, "transition"), (12e-9, "free molecule")],
)
def test_table_a3_names_the_regime_by_fiber_diameter(diameter: float, regime: str) -> None:
    # its diameters are for 65 nm: 13 um, 520 nm, 13 nm
    assert slip.regime(float(slip.knudsen(65e-9, diameter))) == regime
