"""Add fibers one by one until the mat is complete."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator

import numpy as np

from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.geometry.triangles import Floats
from pipeline.mat.chords import draw_chords
from pipeline.mat.deposit import Deposit, as_chord, drop
from pipeline.mat.diameters import draw_diameters
from pipeline.mat.settings import BoxSettings, LayeredSettings
from pipeline.mat.sums import Predict, RunningSums
from pipeline.nouns.fibers import Mat
from pipeline.progress import Progress

_BATCH = 256
"""Fibers drawn at once. Part of what a seed means: another number gives other mats."""


def grow(
    settings: LayeredSettings | BoxSettings,
    rng: np.random.Generator,
    predict: Predict | None,
    progress: Progress,
) -> Mat:
    """Draw fibers and place each until the stop is reached; see `pipeline.mat.generate` for the parameters."""
    stop = settings.stop
    sums = RunningSums(settings.side**2, settings.thickness if isinstance(settings, BoxSettings) else 0.0)
    deposit = Deposit(settings.side if settings.periodic else 0.0)
    for ends, radius in _draws(settings, rng):
        chord = as_chord(ends)
        if isinstance(settings, BoxSettings):
            nodes = _anywhere(chord, radius, settings, rng)
        else:
            _refuse_a_ring(settings, radius)
            nodes = drop(deposit, chord, radius, settings.relaxation_slope, settings.contact, settings.spacing)
        deposit.add(ends, chord, radius, nodes)
        steps = np.diff(nodes, axis=0)
        sums.add(radius, chord[4], float(np.hypot(steps[:, 0], steps[:, 1]).sum()), float(nodes[:, 1].max()))
        value = sums.value(stop, predict)
        if value >= stop.target:
            break
        if sums.count == settings.max_fibers:
            raise CaseError(
                f"mat.stop.{stop.quantity} = {stop.target:g} is not reached by mat.max_fibers = {sums.count} fibers: "
                f"they give {value:.4g}, with coverage {sums.coverage:.3g}, solidity {sums.solidity:.3g} and "
                f"thickness {sums.thickness * 1e6:.3g} um; ask for less or raise mat.max_fibers"
            )
        if sums.count % _BATCH == 0:
            progress(f"{sums.count} fibers", min(value / stop.target, 1.0))
    return Mat(
        nodes=deposit.points(),
        first=deposit.first[: sums.count + 1].copy(),
        radius=deposit.radius[: sums.count].copy(),
        slab=Box((0.0, 0.0, 0.0), (settings.side, settings.side, sums.thickness)),
        seed=settings.seed,
        origin=f"{settings.generator}, until {stop.quantity} {stop.target:g}: {value:.6g}",
        periodic=settings.periodic,
    )


def _draws(settings: LayeredSettings | BoxSettings, rng: np.random.Generator) -> Iterator[tuple[Floats, float]]:
    """Give fiber after fiber, without end: its two ends in plan, and its radius."""
    while True:
        diameters = draw_diameters(settings.fiber_diameter, _BATCH, rng)
        yield from zip(draw_chords(settings, diameters, rng), (0.5 * diameters).tolist(), strict=True)


def _anywhere(chord: Floats, radius: float, settings: BoxSettings, rng: np.random.Generator) -> Floats:
    """Put both ends at uniform heights, so that the whole fiber lies in the slab."""
    room = settings.thickness - 2.0 * radius
    if room < 0.0:
        raise CaseError(
            f"mat.thickness = {settings.thickness:g} m is less than the diameter of a fiber, {2 * radius:g} m; "
            "make the box thicker or bound mat.fiber_diameter"
        )
    low, high = radius + room * rng.random(2)
    return np.array([[0.0, low], [chord[4], high]])


def _refuse_a_ring(settings: LayeredSettings, radius: float) -> None:
    """Refuse a clear fiber so long that it could meet its own image through the sides of a periodic plan."""
    room = settings.side - settings.wrapped_length
    if settings.contact == "clear" and settings.periodic and room < 2.0 * radius + settings.spacing:
        raise CaseError(
            f"a fiber of diameter {2e6 * radius:.3g} um and length {settings.wrapped_length * 1e6:.3g} um could meet "
            f"its own image through the sides of a plan of {settings.side * 1e6:.3g} um; set a shorter mat.fiber_length"
        )
