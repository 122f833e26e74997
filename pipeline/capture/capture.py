"""Send particles of every size through a solved flow, and tell what was caught in the words of filters."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pipeline.analytics.formulas import classes
from pipeline.analytics.formulas.merit import figure_of_merit
from pipeline.analytics.formulas.penetrating import most_penetrating
from pipeline.analytics.models.prediction import depth_of, efficiency_over
from pipeline.analytics.models.single_fiber import PRESETS, penetration, preset
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.capture.cells import Cells
from pipeline.capture.concentration import concentration_penetration
from pipeline.capture.contact import fiber_grid, touching_fibers
from pipeline.capture.counting import Filter, counted
from pipeline.capture.first_row import first_row
from pipeline.capture.intervals import share_interval
from pipeline.capture.langevin import Motion
from pipeline.capture.particles import motion_of
from pipeline.capture.settings import PARTICLES, CaptureSettings, Mechanism
from pipeline.capture.size_curve import most_penetrating_size
from pipeline.capture.splitting import split_penetration
from pipeline.capture.starts import fastest_inflow
from pipeline.capture.trajectories import CAPTURED, PASSED, TIMED_OUT, Duct, Fates, Pace
from pipeline.geometry.box import Box
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.capture import Capture, DepthProfile, MostPenetratingSize, RarePenetration
from pipeline.nouns.fibers import Mat, Pieces
from pipeline.progress import Progress, silent

_TRANSITS = 100.0  # a particle is given up after so many times that the air takes through the duct
_STEPS = 1_000_000
_SLICES = 20
_PATHS = 2000
_COUNTED = 50  # particles that passed, from which the count is left as it is
_SURVIVORS = 4000  # that start from each layer
_MOST_LAYERS = 40
_FORGETS = 0.02  # of a fiber's diameter: the farthest a particle may coast that starts anew with the air's velocity
_MOST_CELLS = 100_000  # for the concentration, which splits each in eight
_RESOLVED = 0.5  # of a cell: the thinnest layer of diffusion that is tried
_TRUSTED = 0.1  # relative error of the capture depth up to which the concentration's answer is given
_ALONE = 5  # of a mechanism alone, one particle for so many of all together
_SIEVED = 0.02  # of the particle's diameter: two fibers within that of its surface hold it together


class Caught(NamedTuple):
    """Where particles stick, one row each.

    Parameters
    ----------
    place : (n, 3) array [m]
        Of their centers.
    particle_diameter : (n,) array [m]
    fiber : (n,) int array
    time : (n,) array [s]
        Since they entered.
    """

    place: Floats
    particle_diameter: Floats
    fiber: Ints
    time: Floats


@dataclass(frozen=True, eq=False, slots=True)
class Medium:
    """The filter that particles are sent through.

    Parameters
    ----------
    mat : Mat
    pieces : Pieces
        The true fibers, with their periodic images.
    box : Box [m]
        The duct.
    wraps : bool
        Whether its sides are cyclic.
    cells : Cells
        The solved flow.
    pressure_drop : float [Pa]
    solver : str
        Who solved it.
    model : FilterSettings
        The filter as the single-fiber model sees it.
    """

    mat: Mat
    pieces: Pieces
    box: Box
    wraps: bool
    cells: Cells
    pressure_drop: float
    solver: str
    model: FilterSettings


def capture(
    medium: Medium, settings: CaptureSettings, air: FlowSettings, progress: Progress = silent, kept: Path | None = None
) -> tuple[Capture, Caught]:
    """Count what a filter catches of particles of each size.

    Parameters
    ----------
    medium : Medium
    settings : CaptureSettings
    air : FlowSettings
    progress : Progress
    kept : Path, optional
        Folder for finished batches, from which a killed run goes on.

    Returns
    -------
    Capture
    Caught
        In the order of sizes and particles.
    """
    sizes = [_size(number, medium, settings, air, progress, kept) for number in range(len(settings.diameters()))]
    stray = _stray(medium, settings, air)
    return _summary(sizes, stray, medium, settings, air), _where(sizes, medium)


def _stray(medium: Medium, settings: CaptureSettings, air: FlowSettings) -> float:
    filter, _ = filter_for(medium, 0.0)
    point = Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    pace = pace_of(float(medium.mat.radius.min()), False, _TRANSITS * medium.box.size[2] / air.face_velocity)
    *_, fates = counted(filter, point, pace, settings.seed, 0, _PATHS, None)
    return float((fates.outcome == CAPTURED).mean())


@dataclass(frozen=True, eq=False, slots=True)
class _Size:
    diameter: float
    fates: Fates
    fiber: Ints  # that caught each particle, -1 where none did
    sieved: int
    alone: dict[Mechanism, float]
    diffused: float | None  # efficiency by the concentration
    rare: RarePenetration | None


def _size(
    number: int, medium: Medium, settings: CaptureSettings, air: FlowSettings, progress: Progress, kept: Path | None
) -> _Size:
    diameters = settings.diameters()
    diameter = diameters[number]
    filter, of_piece = filter_for(medium, diameter)
    at = f"capture: {diameter * 1e9:.4g} nm, size {number + 1} of {len(diameters)}"
    count = settings.particles or (None if settings.half_width else PARTICLES)
    fates = _follow(filter, diameter, settings.mechanisms, number, count, medium, settings, air, progress, at, kept)
    caught = fates.outcome == CAPTURED
    fiber = np.where(caught, of_piece[fates.piece], -1)
    touching = diameter * (0.5 + _SIEVED)
    sieved = int((touching_fibers(fates.place[caught], filter.grid, of_piece, touching) > 1).sum())
    alone = {}
    for mechanism in settings.mechanisms:
        if settings.mechanisms == (mechanism,):
            alone[mechanism] = float(caught.mean())
            continue
        fewer = -(-len(fates.outcome) // _ALONE)
        name = f"{at}, {mechanism} alone"
        some = _follow(filter, diameter, (mechanism,), number, fewer, medium, settings, air, progress, name, kept)
        alone[mechanism] = float((some.outcome == CAPTURED).mean())
    diffused = _diffused(filter, diameter, medium, settings, air, progress, at)
    rare = _rare(filter, diameter, fates, medium, settings, air, progress, at)
    return _Size(diameter, fates, fiber, sieved, alone, diffused, rare)


def _rare(
    filter: Filter, diameter: float, fates: Fates, medium: Medium, settings: CaptureSettings, air: FlowSettings,
    progress: Progress, at: str,
) -> RarePenetration | None:  # fmt: skip
    """Penetration by layers where it is too small to count."""
    motion = _motion(diameter, settings.mechanisms, settings, air)
    thick = 2.0 * float(medium.mat.radius.mean())
    passed, height = int((fates.outcome == PASSED).sum()), np.sort(fates.place[fates.outcome == CAPTURED, 2])
    # few particles in all tell nothing of a small share
    if passed >= _COUNTED or len(height) < max(10 * passed, _COUNTED):
        return None
    if motion.relaxation * air.face_velocity > _FORGETS * thick:
        return None
    bottom, top = medium.mat.slab.lower[2], medium.mat.slab.upper[2]
    # how the survivors thin out with depth, as far as there are some to tell by
    known = max(len(fates.outcome) - _COUNTED, 1)
    reached = float(np.clip(height[min(known, len(height)) - 1], bottom + 0.02 * (top - bottom), top))
    depth = np.log(len(fates.outcome) / (len(fates.outcome) - min(known, len(height)) + 1.0))
    layers = int(np.clip(np.ceil(depth * (top - bottom) / (reached - bottom)), 2, _MOST_LAYERS))
    progress(f"{at}: penetration by {layers} layers")
    planes = np.append(np.linspace(bottom, top, layers + 1)[1:-1], medium.box.upper[2])
    pace = pace_of(
        float(medium.mat.radius.min()), motion.diffusivity > 0.0, _TRANSITS * medium.box.size[2] / air.face_velocity
    )
    return split_penetration(filter, motion, pace, settings.seed, min(len(fates.outcome), _SURVIVORS), planes)


def _diffused(
    filter: Filter,
    diameter: float,
    medium: Medium,
    settings: CaptureSettings,
    air: FlowSettings,
    progress: Progress,
    at: str,
) -> float | None:
    """Efficiency by the concentration, where the cells resolve the layer that diffusion leaves about a fiber."""
    chosen = tuple(name for name in settings.mechanisms if name in ("interception", "diffusion"))
    motion = motion_of(diameter, air.particle_density, air.flow(), preset(air.preset), chosen, "none")
    if motion.diffusivity <= 0.0 or medium.wraps or len(medium.cells.nodes) > _MOST_CELLS:
        return None
    thick = 2.0 * float(medium.mat.radius.mean())
    layer = thick * (motion.diffusivity / (air.face_velocity * thick)) ** (1.0 / 3.0)
    if layer < _RESOLVED * float(np.median(medium.cells.size)):
        return None
    progress(f"{at}: concentration")
    found = concentration_penetration(filter.cells, filter.grid, motion.contact, motion.diffusivity)
    return 1.0 - found.value if found.error < _TRUSTED else None


def filter_for(medium: Medium, diameter: float) -> tuple[Filter, Ints]:
    """Prepare a filter for particles of one size [m]; and the fiber of each of its grid's pieces."""
    pieces, radius = medium.pieces, medium.mat.radius[medium.pieces.fiber]
    lower, upper = np.array(medium.box.lower), np.array(medium.box.upper)
    shifts = [np.zeros(3)]
    if medium.wraps:
        # the particle may reach what stands behind the opposite side
        shifts += [np.array([i, j, 0.0]) * (upper - lower) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    copies = len(shifts)
    grid = fiber_grid(
        np.concatenate([pieces.start + shift for shift in shifts]),
        np.concatenate([pieces.end + shift for shift in shifts]),
        np.tile(radius, copies),
        np.tile(pieces.flat, (copies, 1)),
        lower,
        upper,
        0.5 * diameter * (1.0 + 2.0 * _SIEVED) + 2.0 * float(medium.mat.radius.mean()),
    )
    (x0, y0, inlet), (x1, y1, outlet) = medium.box.lower, medium.box.upper
    duct = Duct(x0, x1, y0, y1, inlet, outlet, medium.wraps)
    return Filter(duct, medium.cells, grid, fastest_inflow(duct, medium.cells)), np.tile(pieces.fiber, copies)[
        grid.source
    ]


def _follow(
    filter: Filter, diameter: float, mechanisms: tuple[Mechanism, ...], number: int, count: int | None, medium: Medium,
    settings: CaptureSettings, air: FlowSettings, progress: Progress, at: str, kept: Path | None,
) -> Fates:  # fmt: skip
    motion = _motion(diameter, mechanisms, settings, air)
    crossing = medium.box.size[2] / air.face_velocity
    pace = pace_of(float(medium.mat.radius.min()), motion.diffusivity > 0.0, _TRANSITS * crossing)
    place = None
    if kept is not None:
        place = kept / "-".join(mechanisms)
        place.mkdir(parents=True, exist_ok=True)
    fates = None
    for fates in counted(filter, motion, pace, settings.seed, number, count, settings.half_width, place):
        trials, caught = len(fates.outcome), int((fates.outcome == CAPTURED).sum())
        low, high = share_interval(caught, trials)
        progress(
            f"{at}: {trials} particles, efficiency {100 * caught / trials:.3g} % ({100 * low:.3g} to {100 * high:.3g})",
            trials / count if count else min((settings.half_width or 1.0) / (0.5 * (high - low)), 1.0) ** 2,
        )
    assert fates is not None  # there is at least one particle
    return fates


def _motion(diameter: float, mechanisms: tuple[Mechanism, ...], settings: CaptureSettings, air: FlowSettings) -> Motion:
    model, density = preset(air.preset), settings.density or air.particle_density
    return motion_of(diameter, density, air.flow(), model, mechanisms, settings.gravity or model.gravity)


def pace_of(radius: float, diffuses: bool, time: float) -> Pace:
    """Choose the steps: what docs/verification.md shows to be fine enough.

    Parameters
    ----------
    radius : float [m]
        Of the thinnest fiber.
    diffuses : bool
        Whether Brownian motion moves the particles; without it steps beside a fiber are shorter, because no bridge
        tells what was missed.
    time : float [s]
        After which a particle is given up.
    """
    return Pace(0.25, 0.3, (0.1 if diffuses else 0.05) * radius, True, time, _STEPS)


def _summary(sizes: list[_Size], stray: float, medium: Medium, settings: CaptureSettings, air: FlowSettings) -> Capture:
    diameter = np.array([size.diameter for size in sizes])
    outcomes = {
        kind: np.array([int((size.fates.outcome == kind).sum()) for size in sizes])
        for kind in (PASSED, CAPTURED, TIMED_OUT)
    }
    caught, lost, passed = outcomes[CAPTURED], outcomes[TIMED_OUT], outcomes[PASSED]
    released = np.array([len(size.fates.outcome) for size in sizes])
    efficiency = caught / released
    bounds = [share_interval(*map(int, counts)) for counts in zip(caught, released, lost, strict=True)]
    air = air.model_copy(update={"particle_density": settings.density or air.particle_density})
    # a size that nothing passed has no depth, only a least one
    depth = [
        -np.log(size.rare.penetration) if size.rare else -np.log1p(-share) if share < 1.0 else None
        for size, share in zip(sizes, efficiency, strict=True)
    ]
    per_depth = float(depth_of(medium.model, 1.0))
    flow = most_penetrating_size(diameter, caught, released, settings.seed)
    worst = max(size.rare.high if size.rare else 1.0 - low for size, (low, _) in zip(sizes, bounds, strict=True))
    groups = {name: classes.particulate_efficiency(diameter, efficiency, name) for name in classes.ISO_16890}
    return Capture(
        particle_diameter=tuple(diameter.tolist()),
        efficiency=tuple(efficiency.tolist()),
        low=tuple(low for low, _ in bounds),
        high=tuple(high for _, high in bounds),
        penetration=tuple((1.0 - efficiency).tolist()),
        released=tuple(released.tolist()),
        captured=tuple(caught.tolist()),
        passed=tuple(passed.tolist()),
        timed_out=tuple(lost.tolist()),
        sieved=tuple(size.sieved for size in sizes),
        fiber_efficiency=tuple(None if each is None else float(each) / per_depth for each in depth),
        single_fiber=tuple(efficiency_over(medium.model, air, diameter)["total"].tolist()),
        by_mechanism={name: tuple(size.alone[name] for size in sizes) for name in settings.mechanisms},
        first_row=_first_row(sizes, medium, released),
        concentration=tuple(size.diffused for size in sizes),
        rare_penetration=tuple(size.rare for size in sizes),
        residence_time=tuple(_mean(size.fates.time[size.fates.outcome == PASSED]) for size in sizes),
        figure_of_merit=tuple(
            None if each is None else float(figure_of_merit(each, medium.pressure_drop)) for each in depth
        ),
        pressure_drop=medium.pressure_drop,
        mechanisms=settings.mechanisms,
        density=air.particle_density,
        most_penetrating={"cfd": flow, "model": _model_size(medium.model, air)},
        en_1822=classes.en_1822_class(worst) if flow.inside else None,
        iso_29463=classes.iso_29463_class(worst) if flow.inside else None,
        iso_16890=groups,
        iso_16890_group=classes.iso_16890_group(groups),
        depth=_depth_profile(sizes, medium),
        seed=settings.seed,
        flow_solver=medium.solver,
        stray=stray,
    )


def _mean(values: Floats) -> float | None:
    return float(values.mean()) if len(values) else None


def _first_row(sizes: list[_Size], medium: Medium, released: Ints) -> tuple[float, ...] | None:
    found = first_row(medium.mat)
    if found is None:
        return None
    fibers, area = found
    share = medium.mat.slab.face_area / area
    return tuple(
        float(fibers[size.fiber[size.fiber >= 0]].sum() / count * share)
        for size, count in zip(sizes, released, strict=True)
    )


def _model_size(model: FilterSettings, air: FlowSettings) -> MostPenetratingSize:
    found = {
        name: most_penetrating(each, air.flow(), model.solidity, model.fiber_diameter, air.particle_density)
        for name, each in PRESETS.items()
    }
    own = found[air.preset]
    others = [each.diameter for each in found.values() if each.inside] or [own.diameter]
    return MostPenetratingSize(
        diameter=own.diameter,
        low=min(others),
        high=max(others),
        penetration=float(penetration(depth_of(model, own.single_fiber))),
        inside=own.inside,
    )


def _depth_profile(sizes: list[_Size], medium: Medium) -> DepthProfile:
    edges = np.linspace(medium.mat.slab.lower[2], medium.mat.slab.upper[2], _SLICES + 1)
    heights = [size.fates.place[size.fates.outcome == CAPTURED, 2] for size in sizes]
    counts = [np.histogram(np.clip(z, edges[0], edges[-1]), edges)[0] for z in heights]
    return DepthProfile(tuple(edges.tolist()), tuple(tuple(count.tolist()) for count in counts))


def _where(sizes: list[_Size], medium: Medium) -> Caught:
    rows = [size.fates.outcome == CAPTURED for size in sizes]
    return Caught(
        place=np.concatenate([size.fates.place[row] for size, row in zip(sizes, rows, strict=True)]),
        particle_diameter=np.concatenate(
            [np.full(int(row.sum()), size.diameter) for size, row in zip(sizes, rows, strict=True)]
        ),
        fiber=np.concatenate([size.fiber[row] for size, row in zip(sizes, rows, strict=True)]),
        time=np.concatenate([size.fates.time[row] for size, row in zip(sizes, rows, strict=True)]),
    )
