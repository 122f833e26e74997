"""One record for one filter: what it holds, how it is written, drawn, and read back."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from pipeline.analytics.formulas import air
from pipeline.analytics.formulas.polydisperse import lognormal_mean, mass_median
from pipeline.analytics.models.prediction import predict
from pipeline.analytics.models.pressure_models import MODELS
from pipeline.analytics.models.single_fiber import MECHANISMS
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.analytics.tables.plots import plot_prediction, save_figure
from pipeline.analytics.tables.rows import prediction_tables
from pipeline.errors import CaseError
from pipeline.units import FROM_FILE
from validation.paper_figures import FIGURE_10, FIGURE_11, FIGURE_12, SLOW, write_paper_figures

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"


def test_the_record_writes_to_json_with_the_keys_that_others_build_on() -> None:
    written = json.loads(json.dumps(dataclasses.asdict(predict(FIGURE_10, SLOW)), allow_nan=False))
    assert set(written["pressure_drop"]) == set(MODELS)
    assert set(written["efficiency"]) == {"total", *MECHANISMS} == set(written["single_fiber"])
    assert {"diameter", "efficiency"} <= set(written["mpps"])
    assert set(written["figure_of_merit"]) == {"a34", "paper"}


def test_a_model_without_an_answer_is_null_in_json() -> None:
    dense = FIGURE_10.model_copy(update={"solidity": 0.55})
    prediction = predict(dense, SLOW)
    assert prediction.pressure_drop["spielman_goren_layers"] is None
    json.dumps(dataclasses.asdict(prediction), allow_nan=False)
    assert any("no answer" in row for table in prediction_tables(prediction) for row in table.rows)


@pytest.mark.parametrize(
    ("medium", "efficient", "permeable"), [(FIGURE_10, False, True), (FIGURE_11, True, True), (FIGURE_12, True, True)]
)
def test_the_hepa_check_says_what_the_paper_says_of_its_filters(
    medium: FilterSettings, efficient: bool, permeable: bool
) -> None:
    hepa = predict(medium, SLOW).hepa
    assert (float(hepa["efficiency"] or 0) >= 0.9997) is efficient
    assert (float(hepa["pressure_drop"] or 0) <= 320.0) is permeable
    assert hepa["passes"] is (efficient and permeable)


def test_the_hepa_check_is_at_its_own_velocity_and_size() -> None:
    fast = FlowSettings(face_velocity=0.1, particle_diameter=1e-6)
    assert predict(FIGURE_12, fast).hepa == predict(FIGURE_12, SLOW).hepa


def test_twice_the_hepa_filter_resists_too_much() -> None:
    double = FIGURE_11.model_copy(update={"thickness": 2 * FIGURE_11.thickness})
    assert predict(double, SLOW).hepa["passes"] is False


def test_alone_no_mechanism_catches_more_than_all_do() -> None:
    efficiency = predict(FIGURE_10, SLOW).efficiency
    assert all(efficiency[name] < efficiency["total"] for name in MECHANISMS)


def test_inertia_and_particles_larger_than_the_cell_are_warned_of() -> None:
    warnings = predict(FIGURE_10, FlowSettings(face_velocity=2.0, particle_diameter=8e-6)).warnings
    assert any("Reynolds" in text for text in warnings)
    assert any("cell" in text for text in warnings)
    assert predict(FIGURE_10, SLOW).warnings == ()


def test_a_filter_without_a_least_efficient_size_says_so() -> None:
    # at that speed no particle of 1 nm has the time to diffuse: efficiency rises with size from the start
    # (no case file gets that far: it is Mach 2,900)
    fast = FlowSettings().model_copy(update={"face_velocity": 1e6})
    assert any("no most penetrating size" in text for text in predict(FIGURE_10, fast).warnings)


# -- air -------------------------------------------------------------------------------------------------------------


def test_air_is_the_standard_atmospheres_at_15_celsius() -> None:
    # U.S. Standard Atmosphere 1976 at sea level: 1.7894e-5 Pa s, 1.2250 kg/m3, mean free path 66.3 nm
    assert air.viscosity(288.15) == pytest.approx(1.7894e-5, rel=5e-5)
    assert air.density(288.15) == pytest.approx(1.2250, rel=5e-5)
    assert air.mean_free_path(288.15) == pytest.approx(66.3e-9, rel=0.04)


@given(temperature=st.floats(200.0, 500.0), pressure=st.floats(1e4, 1e6))
def test_the_mean_free_path_follows_kinetic_theory(temperature: float, pressure: float) -> None:
    # lambda = eta / (0.499 rho c): the same law of viscosity must be in both
    def ratio(t: float, p: float) -> float:
        return air.mean_free_path(t, p) * air.density(t, p) * math.sqrt(t) / air.viscosity(t)

    assert ratio(temperature, pressure) == pytest.approx(ratio(293.0, 101325.0), rel=1e-9)


def test_what_is_given_is_not_worked_out() -> None:
    flow = FlowSettings(viscosity=1e-5, density=2.0, mean_free_path=1e-7).flow()
    assert (flow.viscosity, flow.density, flow.mean_free_path) == (1e-5, 2.0, 1e-7)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("face_velocity", 0.025),
        ("face_velocity", "2.5 um"),
        ("face_velocity", "-1 cm/s"),
        ("temperature", "20"),
        ("preset", "brown"),
        ("pressure_model", "darcy"),
        ("particle_spread", 0.5),
        ("wind", "1 m/s"),
    ],
)
def test_the_case_file_s_flow_refuses_nonsense(key: str, value: object) -> None:
    with pytest.raises(ValidationError, match=key):
        FlowSettings.model_validate({key: value}, context=FROM_FILE)


# -- aerosols of many sizes ------------------------------------------------------------------------------------------


@given(power=st.floats(-2.0, 3.0), median=st.floats(1e-8, 1e-5), deviation=st.floats(1.01, 2.5))
def test_moments_of_a_lognormal_distribution_are_exact(power: float, median: float, deviation: float) -> None:
    # <d^p> = m^p exp(p^2 s^2 / 2)
    mean = lognormal_mean(lambda d: (d / median) ** power, median, deviation)
    assert mean == pytest.approx(math.exp(0.5 * (power * math.log(deviation)) ** 2), rel=1e-6)


@given(median=st.floats(1e-8, 1e-5), deviation=st.floats(1.01, 2.5))
def test_averaging_by_mass_is_weighing_by_the_cube(median: float, deviation: float) -> None:
    # Hatch and Choate's median must give what weighing each size by d^3 gives
    def of(d: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        return np.asarray(1.0 / (1.0 + d / median))

    cube = lognormal_mean(lambda d: (d / median) ** 3, median, deviation)
    weighed = lognormal_mean(lambda d: of(d) * (d / median) ** 3, median, deviation) / cube
    assert lognormal_mean(of, mass_median(median, deviation), deviation) == pytest.approx(weighed, rel=1e-5)


def test_a_single_size_is_its_own_average() -> None:
    prediction = predict(FIGURE_10, SLOW)
    assert prediction.aerosol["count"] == prediction.efficiency["total"] == prediction.aerosol["mass"]


def test_spread_about_the_most_penetrating_size_can_only_help() -> None:
    size = predict(FIGURE_10, SLOW).mpps["diameter"]
    previous = predict(FIGURE_10, SLOW).mpps["efficiency"]
    for spread in (1.2, 1.6, 2.2):
        wider = predict(FIGURE_10, FlowSettings(particle_diameter=size, particle_spread=spread)).aerosol["count"]
        assert wider > previous
        previous = wider


# -- tables and figures ----------------------------------------------------------------------------------------------


def test_the_tables_have_a_cell_for_every_column() -> None:
    spread = FlowSettings(particle_spread=1.6)
    for table in prediction_tables(predict(FIGURE_10, spread)):
        assert table.rows
        assert all(len(row) == len(table.columns) for row in table.rows)
    assert any("by mass" in row[0] for row in prediction_tables(predict(FIGURE_10, spread))[-1].rows)


def test_the_plot_has_the_three_panels(tmp_path: Path) -> None:
    figure = plot_prediction(FIGURE_10, SLOW)
    efficiency, merit, drop = figure.axes
    assert len(efficiency.get_lines()) == 2 + len(MECHANISMS)  # and the dot
    assert len(merit.get_lines()) == 2
    legend = drop.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [model.title for model in MODELS.values()]
    save_figure(figure, tmp_path / "plot.png")
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")


def test_a_plot_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    figure = plot_prediction(FIGURE_10, SLOW)
    with pytest.raises(CaseError, match=r"\.svg, \.png, \.pdf"):
        save_figure(figure, tmp_path / "plot.doc")
    with pytest.raises(CaseError, match="cannot write"):
        save_figure(figure, tmp_path / "nowhere" / "plot.png")


def test_the_papers_figures_are_drawn_alike_each_time_and_small(tmp_path: Path) -> None:
    first, again = tmp_path / "first", tmp_path / "again"
    first.mkdir()
    again.mkdir()
    for one, other in zip(write_paper_figures(first), write_paper_figures(again), strict=True):
        assert one.read_bytes() == other.read_bytes()
        assert one.stat().st_size < 150_000
        assert ElementTree.parse(one).getroot().tag.endswith("svg")
        assert (GALLERY / one.name).exists()


def test_the_papers_slip_term_is_told_by_how_much_it_lowers_interception() -> None:
    medium = FilterSettings(solidity=0.135, thickness=16e-6, fiber_diameter=1.4e-6)

    def rows(preset: str) -> dict[str, str]:
        settings = FlowSettings(preset=preset)  # type: ignore[arg-type]
        return {row[0]: row[1] for table in prediction_tables(predict(medium, settings)) for row in table.rows}

    told = rows("paper")["slip in the preset paper (Eq. A11)"]
    paper, simple = (
        predict(medium, FlowSettings(preset=name)).single_fiber["interception"] for name in ("paper", "hinds")
    )
    assert told.startswith(f"lowers interception by {1 - paper / simple:.0%}")
    assert not [name for name in rows("hinds") if name.startswith("slip")]
