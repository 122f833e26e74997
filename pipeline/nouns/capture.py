"""What the filter caught of particles of each size."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

from pipeline.nouns.arrays import require


@dataclass(frozen=True, slots=True)
class MostPenetratingSize:
    """The particle size that the filter holds back least.

    Parameters
    ----------
    diameter : float [m]
    low, high : float [m]
        From the flow: its 95 % interval. From the model: the least and the largest that its presets give.
    penetration : float [-]
        Share of the particles of that size that pass.
    inside : bool
        Whether it is a true minimum between the sizes looked at; else the end at which penetration is highest.
    """

    diameter: float
    low: float
    high: float
    penetration: float
    inside: bool


@dataclass(frozen=True, slots=True)
class RarePenetration:
    """A penetration too small to count, as the product of what passes layer after layer.

    Parameters
    ----------
    penetration, low, high : float [-]
        With its 95 % interval.
    layers : int
    """

    penetration: float
    low: float
    high: float
    layers: int


@dataclass(frozen=True, slots=True)
class DepthProfile:
    """How deep particles stick.

    Parameters
    ----------
    edges : tuple of float [m]
        Bounds of slices of the mat across the flow, from its upstream side.
    captured : tuple of tuple of int
        For each size, particles that stick in each slice; one that sticks outside the slab counts in the nearest.
    """

    edges: tuple[float, ...]
    captured: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True)
class Capture:
    """Which particles a filter catches, over their size; every tuple has one entry per size.

    Parameters
    ----------
    particle_diameter : tuple of float [m]
        Rising.
    efficiency, low, high : tuple of float [-]
        Captured over released, and its 95 % interval (Clopper and Pearson); a particle that was given up counts as
        passed in `low` and as captured in `high`.
    penetration : tuple of float [-]
        1 less efficiency.
    released, captured, passed, timed_out : tuple of int
        Particles; the last three sum to the first.
    sieved : tuple of int
        Of the captured, those that touched two fibers at once: they were larger than the gap.
    fiber_efficiency : tuple of float or None [-]
        Single-fiber efficiency that the penetration stands for (Eq. A28); None where nothing passed.
    single_fiber : tuple of float [-]
        The filter's efficiency by the single-fiber model.
    by_mechanism : dict of str to tuple of float [-]
        The filter's efficiency with each mechanism alone, by trajectories.
    first_row : tuple of float or None
        For arrays of straight fibers across the flow: what the fibers that air meets first catch, per their projected
        area; None else.
    concentration : tuple of float or None [-]
        The filter's efficiency from convection and diffusion of the concentration (particles without inertia and
        weight); None where it was not solved for.
    rare_penetration : tuple of RarePenetration or None
        Where fewer than 50 particles passed: the penetration by layers; None elsewhere, and for particles whose inertia
        carries them from layer to layer.
    residence_time : tuple of float or None [s]
        Mean from inlet to outlet of those that passed; None where none did.
    figure_of_merit : tuple of float or None [1/Pa]
        -ln(penetration) over the pressure drop.
    pressure_drop : float [Pa]
    mechanisms : tuple of str
        What brought particles to the fibers.
    density : float [kg/m3]
        Of the particles.
    most_penetrating : dict of str to MostPenetratingSize
        By trajectories through the solved flow (``cfd``) and by the single-fiber model (``model``).
    en_1822, iso_29463 : str or None
        Class at the most penetrating size, by the upper end of its penetration's interval; None below the lowest.
    iso_16890 : dict of str to float or None [-]
        ``ePM1``, ``ePM2.5``, ``ePM10``; None where the sizes do not cover the group.
    iso_16890_group : str or None
    depth : DepthProfile
    seed : int
    flow_solver : str
        Whose velocity the particles followed.
    stray : float [-]
        Share of the air's own paths that end on a fiber, which none should: what mesh and flow add to the efficiency of
        points.
    """

    particle_diameter: tuple[float, ...]
    efficiency: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    penetration: tuple[float, ...]
    released: tuple[int, ...]
    captured: tuple[int, ...]
    passed: tuple[int, ...]
    timed_out: tuple[int, ...]
    sieved: tuple[int, ...]
    fiber_efficiency: tuple[float | None, ...]
    single_fiber: tuple[float, ...]
    by_mechanism: dict[str, tuple[float, ...]]
    first_row: tuple[float, ...] | None
    concentration: tuple[float | None, ...]
    rare_penetration: tuple[RarePenetration | None, ...]
    residence_time: tuple[float | None, ...]
    figure_of_merit: tuple[float | None, ...]
    pressure_drop: float
    mechanisms: tuple[str, ...]
    density: float
    most_penetrating: dict[str, MostPenetratingSize]
    en_1822: str | None
    iso_29463: str | None
    iso_16890: dict[str, float | None]
    iso_16890_group: str | None
    depth: DepthProfile
    seed: int
    flow_solver: str
    stray: float

    def __post_init__(self) -> None:
        ends = zip(self.released, self.captured, self.passed, self.timed_out, strict=True)
        lost = [released - sum(parts) for released, *parts in ends]
        require(not any(lost), f"{sum(lost)} particles have no end")
