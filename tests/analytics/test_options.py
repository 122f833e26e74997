"""What a person types is read with its units, over what a case already says, and refused in one go."""

# SPDX-License-Identifier: GPL-3.0-or-later

import pytest

from pipeline.analytics.options import read_options
from pipeline.analytics.settings import FlowSettings
from pipeline.errors import CaseError
from validation.paper_figures import FIGURE_10

TYPED = {
    "solidity": "9.48 %",
    "thickness": "47 um",
    "fiber_diameter": "1.4 um",
    "face_velocity": "2.5 cm/s",
    "particle_diameter": "0.2 um",
    "temperature": "20 degC",
    "preset": "hinds",
}


def test_every_option_is_read_in_its_unit() -> None:
    medium, flow = read_options(TYPED)
    assert medium == FIGURE_10
    assert flow == FlowSettings(face_velocity=0.025, particle_diameter=2e-7, temperature=293.15, preset="hinds")


def test_a_bare_solidity_is_a_share() -> None:
    assert read_options({**TYPED, "solidity": "0.0948"})[0] == FIGURE_10


def test_what_is_typed_goes_over_what_the_case_says_and_leaves_the_rest() -> None:
    case = FlowSettings(face_velocity=0.1, viscosity=2e-5)
    medium, flow = read_options({"thickness": "94 um", "temperature": "300 K"}, FIGURE_10, case)
    assert medium == FIGURE_10.model_copy(update={"thickness": 94e-6})
    assert flow == FlowSettings(face_velocity=0.1, viscosity=2e-5, temperature=300.0)


def test_all_mistakes_come_at_once_by_the_names_of_the_options() -> None:
    with pytest.raises(CaseError) as refused:
        read_options({"solidity": "120 %", "thickness": "47", "preset": "brown", "wind": "1 m/s"})
    lines = str(refused.value).splitlines()
    assert [line.split(" ")[0] for line in lines] == [
        "--solidity",
        "--thickness",
        "--fiber-diameter",
        "--preset",
        "--wind:",
    ]
    assert "is missing" in lines[2]


@pytest.mark.parametrize(
    ("key", "last", "beyond"),
    [
        # Sutherland's law holds to about 1 % from 170 to 1900 K (U.S. Standard Atmosphere), the ideal gas up to 100 bar
        ("temperature", "170 K", "169.9 K"),
        ("temperature", "1900 K", "1901 K"),
        ("pressure", "100 bar", "101 bar"),
    ],
)
def test_the_laws_of_air_are_used_up_to_their_limits_and_no_farther(key: str, last: str, beyond: str) -> None:
    medium = {"solidity": "5 %", "thickness": "1 mm", "fiber_diameter": "2 um"}
    read_options({**medium, key: last})
    with pytest.raises(CaseError, match=f"{key} is"):
        read_options({**medium, key: beyond})
