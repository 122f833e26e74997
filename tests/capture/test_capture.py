"""What is told of a filter with one fiber: counts, intervals, sizes, rows, repeatability."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from pipeline.analytics.settings import FlowSettings
from pipeline.capture import counting
from pipeline.capture.capture import capture
from pipeline.capture.settings import CaptureSettings
from tests.capture.media import RADIUS, SIDE, SPEED, straight_fibers

AIR = FlowSettings(face_velocity=SPEED)


def test_without_diffusion_even_air_brings_a_fiber_what_it_shades_and_the_row_is_per_projected_area() -> None:
    diameter = 0.6 * RADIUS
    settings = CaptureSettings(particle_diameters=(diameter,), particles=4000, mechanisms=("interception",))
    found, caught = capture(straight_fibers(), settings, AIR)
    # starts are as even as the plane allows: the share scatters far less than counts do
    assert found.efficiency[0] == pytest.approx(2 * 1.3 * RADIUS / SIDE, abs=2e-3)
    assert found.first_row is not None
    assert found.first_row[0] == pytest.approx(1.3, rel=6e-3)
    assert found.by_mechanism == {"interception": found.efficiency}
    away = np.hypot(caught.place[:, 0] - 0.5 * SIDE, caught.place[:, 2] - 8e-6)
    # no step carries a particle deeper into the fiber than a twentieth of its radius
    assert away == pytest.approx(1.3 * RADIUS, abs=0.05 * RADIUS)
    assert (caught.fiber == 0).all()


def test_every_particle_has_an_end_and_the_interval_holds_the_share() -> None:
    settings = CaptureSettings(particle_diameters=(30e-9, 300e-9, 3e-6), particles=600)
    found, caught = capture(straight_fibers(), settings, AIR)
    for k in range(3):
        assert found.captured[k] + found.passed[k] + found.timed_out[k] == found.released[k] == 600
        assert found.low[k] < found.efficiency[k] < found.high[k]
        assert sum(found.depth.captured[k]) == found.captured[k]
    assert len(caught.place) == sum(found.captured)
    assert set(found.by_mechanism) == {"interception", "diffusion", "inertia", "gravity"}
    # from the inlet to the outlet, 16 um at 5 cm/s, within a tenth
    assert found.residence_time[1] == pytest.approx(16e-6 / SPEED, rel=0.1)


def test_the_result_is_the_same_for_any_number_of_threads_and_for_a_run_that_goes_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    settings = CaptureSettings(particle_diameters=(100e-9,), particles=1300, mechanisms=("diffusion", "interception"))
    monkeypatch.setattr(counting, "cores", lambda: 1)
    alone, where = capture(straight_fibers(), settings, AIR, kept=tmp_path)
    batches = sorted(tmp_path.rglob("*.npz"))
    # a run that was killed: some batches are there, one was cut short
    batches[0].unlink()
    batches[1].write_bytes(batches[1].read_bytes()[:50])
    monkeypatch.setattr(counting, "cores", lambda: 3)
    again, there = capture(straight_fibers(), settings, AIR, kept=tmp_path)
    assert again == alone
    assert np.array_equal(where.place, there.place)
    _, other = capture(straight_fibers(), settings.model_copy(update={"seed": 2}), AIR)
    assert not np.array_equal(where.place[:100], other.place[:100])


def test_a_half_width_is_reached() -> None:
    settings = CaptureSettings(particle_diameters=(100e-9,), half_width=0.02, mechanisms=("interception", "diffusion"))
    found, _ = capture(straight_fibers(), settings, AIR)
    assert 0.5 * (found.high[0] - found.low[0]) <= 0.02
    # at a share of .28 that takes 1900 particles, and no more than a round beyond
    assert 1500 < found.released[0] < 4000


def test_particles_that_no_gap_lets_pass_are_counted_as_caught_between_two_fibers() -> None:
    # between fibers at 1.5 and 4.5 um there is a gap of 1.6 um, and the same at the sides
    settings = CaptureSettings(particle_diameters=(1.7e-6,), particles=500, mechanisms=("interception",))
    found, _ = capture(straight_fibers(x=(1.5e-6, 4.5e-6)), settings, AIR)
    assert found.captured == (500,)
    # those that start within .02 um of the middle touch both
    assert 1 <= found.sieved[0] <= 10


def test_a_fiber_beside_a_cyclic_side_catches_through_it() -> None:
    settings = CaptureSettings(particle_diameters=(2 * RADIUS,), particles=2000, mechanisms=("interception",))
    found, _ = capture(straight_fibers(x=(0.2 * RADIUS,), wraps=True), settings, AIR)
    assert found.efficiency[0] == pytest.approx(4 * RADIUS / SIDE, abs=3e-3)


def test_particles_that_rest_are_given_up_and_widen_the_interval_and_are_not_dropped() -> None:
    # gravity against the flow, as fast as the air: nothing moves but what diffuses
    medium = straight_fibers(lambda places: np.column_stack([np.zeros((len(places), 2)), 1e-12 + 0 * places[:, 2]]))
    settings = CaptureSettings(particle_diameters=(1e-6,), particles=50, mechanisms=("interception",))
    found, _ = capture(medium, settings, AIR)
    assert found.timed_out[0] == 50
    assert (found.low[0], found.high[0]) == (0.0, 1.0)


def test_a_range_has_even_steps_of_the_logarithm_and_both_ends() -> None:
    table = {"smallest": "30 nm", "largest": "3 um", "count": 5}
    sizes = CaptureSettings.model_validate({"particle_diameters": table}).diameters()
    assert (sizes[0], sizes[-1]) == (30e-9, 3e-6)
    assert [math.log10(b / a) for a, b in itertools.pairwise(sizes)] == pytest.approx([0.5] * 4, abs=1e-5)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"particles": 10, "half_width": 0.1}, "not both"),
        ({"particle_diameters": []}, "at least one size"),
        ({"particle_diameters": ["1 um", "1000 nm"]}, "stands twice"),
        ({"mechanisms": []}, "nothing would be caught"),
        ({"particles": 0}, "greater than or equal to 1"),
        ({"particle_diameters": {"smallest": "1 um", "largest": "1 um", "count": 3}}, "not below the largest"),
        ({"particle_diameters": {"smallest": "1 um", "largest": "2 um"}}, "count: field required"),
        ({"particle_diameters": {"smallest": "1 kg", "largest": "2 um", "count": 3}}, "smallest: write a number"),
        ({"particle_diameters": ["5 kg"]}, "write a number with a unit"),
    ],
)
def test_nonsense_is_refused_with_words(keys: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        CaptureSettings.model_validate(keys)
