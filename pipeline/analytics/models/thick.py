"""A thick medium from a solved slab of it: the slab keeps its ends, what is added has the gradient of its inside."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pipeline.errors import CaseError
from pipeline.nouns.arrays import Floats
from pipeline.nouns.capture import Capture
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution

_PIECES = 12  # of each straight piece of a fiber along and across it, over which its drag is spread
_PLACES = 1000  # heights at which the fall of the pressure is looked at
_ENDS = 0.15  # of the fibers' volume on either side that counts as the end of the slab
_APART = 2.0  # mean diameters between layers that are taken as independent
_FEW = 3
"""Layers, or slabs, from which a scatter can be told."""


@dataclass(frozen=True, slots=True)
class Slab:
    """What a solved slab tells of the medium that it is a piece of.

    Parameters
    ----------
    thickness : float [m]
    pressure_drop : float [Pa]
    gradient : float [Pa/m]
        Of the pressure within the inner slab, by the drag on the fibers there.
    inner : tuple of 2 floats [m]
        Where the inner slab begins and ends: between 15 and 85 % of the fibers' volume.
    solid_ratio : float [-]
        Fibers per thickness of the inner slab over those of the whole.
    layers : tuple of float [Pa/m]
        Gradients of layers of the inner slab, two mean diameters thick each.
    mesh_error, seed_spread : optional
        As `pipeline.nouns.flow.Solution` has them.
    """

    thickness: float
    pressure_drop: float
    gradient: float
    inner: tuple[float, float]
    solid_ratio: float
    layers: tuple[float, ...]
    mesh_error: tuple[float, float, float] | None = None
    seed_spread: float | None = None


@dataclass(frozen=True, slots=True)
class Share:
    """What may move a number: a name, how much to either side [Pa], and where that is from."""

    name: str
    half_width: float
    source: str


@dataclass(frozen=True, slots=True)
class ThickMedium:
    """The pressure drop of a thick medium, and what passes of each particle size.

    Parameters
    ----------
    thickness : float [m]
    face_velocity : float [m/s]
    pressure_drop, low, high : float [Pa]
    shares : tuple of Share
        What the interval is made of; independent of each other.
    slabs : int
    slab_thickness : float [m]
        Mean over the slabs.
    by_proportion : float [Pa]
        The slab's drop times the ratio of the thicknesses, for comparison.
    particle_diameter : tuple of float [m]
    penetration, penetration_low, penetration_high : tuple of float [-]
    """

    thickness: float
    face_velocity: float
    pressure_drop: float
    low: float
    high: float
    shares: tuple[Share, ...]
    slabs: int
    slab_thickness: float
    by_proportion: float
    particle_diameter: tuple[float, ...] = ()
    penetration: tuple[float, ...] = ()
    penetration_low: tuple[float, ...] = ()
    penetration_high: tuple[float, ...] = ()


def slab_of(mat: Mat, solution: Solution) -> Slab:
    """Read from the drag on each fiber how the pressure falls through a slab.

    Parameters
    ----------
    mat : Mat
    solution : Solution
        With the drag per fiber.

    Raises
    ------
    CaseError
        If the solver did not tell the drag of each fiber.
    """
    if len(solution.drag_per_fiber) != mat.fibers:
        raise CaseError(
            "this flow has no drag per fiber, which tells the slab's inside from its ends: solve it with "
            "solve.engine = stokes"
        )
    height, drag, volume = _spread(mat, np.array(solution.drag_per_fiber))
    order = np.argsort(height)
    height, fall, solid = height[order], np.cumsum(drag[order]), np.cumsum(volume[order])
    low, high = (float(height[np.searchsorted(solid, level * solid[-1])]) for level in (_ENDS, 1.0 - _ENDS))
    area = mat.slab.size[0] * mat.slab.size[1]
    count = int((high - low) / (_APART * 2.0 * float(mat.radius.mean())))
    edges = np.linspace(low, high, count + 1)
    return Slab(
        thickness=mat.thickness,
        pressure_drop=solution.pressure_drop,
        gradient=_slope(height, fall, low, high) / area,
        inner=(low, high),
        solid_ratio=_slope(height, solid, low, high) * mat.thickness / float(solid[-1]),
        layers=tuple(np.diff(_at(height, fall, edges) / area / np.diff(edges).mean()).tolist()),
        mesh_error=solution.mesh_error,
        seed_spread=solution.seed_spread,
    )


def _at(height: Floats, summed: Floats, places: Floats) -> Floats:
    """Sum of all below each place."""
    return np.concatenate([[0.0], summed])[np.searchsorted(height, places)]


def _slope(height: Floats, summed: Floats, low: float, high: float) -> float:
    """Slope of a sum over the height, by least squares: where its ends fall between two fibers matters little."""
    places = np.linspace(low, high, _PLACES)
    off = places - places.mean()
    return float(off @ _at(height, summed, places) / (off @ off))


def _spread(mat: Mat, drag: Floats) -> tuple[Floats, Floats, Floats]:
    """Height [m], drag [N] and volume [m3] of small pieces of all fibers; a fiber's drag is even in its volume."""
    start, fiber, lengths = mat.segment_starts(), mat.segment_fibers(), mat.segment_lengths()
    along = (np.arange(_PIECES) + 0.5) / _PIECES
    # slices of a circle that have equal areas would do as well: chords are their weights
    across = 2.0 * (np.arange(_PIECES) + 0.5) / _PIECES - 1.0
    weight = np.sqrt(1.0 - across**2) / np.sqrt(1.0 - across**2).sum() / _PIECES
    z = mat.nodes[:, 2]
    middle = z[start][:, None] + along * (z[start + 1] - z[start])[:, None]
    height = middle[:, :, None] + mat.radius[fiber][:, None, None] * across
    of_fiber = np.bincount(fiber, lengths, mat.fibers)
    parts = ((drag / of_fiber)[fiber] * lengths, math.pi * mat.radius[fiber] ** 2 * lengths)
    drags, volumes = (np.broadcast_to(part[:, None, None] * weight, height.shape).ravel() for part in parts)
    return height.ravel(), drags, volumes


def thicken(
    slabs: Sequence[Slab],
    thickness: float,
    face_velocity: float,
    speed_ratio: float = 1.0,
    capture: Capture | None = None,
) -> ThickMedium:
    r"""Scale solved slabs to a thick medium.

    .. math:: \Delta p(T) = \Delta p(t) + g\,(T - t)

    with :math:`g` the gradient of the pressure inside the slab; the drop grows with the velocity, as creeping flow has
    it, and :math:`\ln P(T) = \ln P(t)\,(1 + r\,(T - t) / t)` with :math:`r` the ratio of fibers inside to those of the
    whole slab.

    Parameters
    ----------
    slabs : sequence of Slab
        Of one medium: several seeds.
    thickness : float [m]
        Of the medium, at least that of every slab.
    face_velocity : float [m/s]
    speed_ratio : float [-]
        That velocity over the one at which the slabs were solved.
    capture : Capture, optional
        Of the first slab, at the same velocity.

    Raises
    ------
    CaseError
        If the medium is thinner than a slab.
    """
    thickest = max(slab.thickness for slab in slabs)
    if thickness < thickest:
        raise CaseError(
            f"--thickness {1e6 * thickness:.4g} um is less than the slab's {1e6 * thickest:.4g} um: a slab is scaled "
            "up, not cut"
        )
    drops = np.array([slab.pressure_drop + slab.gradient * (thickness - slab.thickness) for slab in slabs])
    flat = np.array([slab.pressure_drop * thickness / slab.thickness for slab in slabs])
    value = float(drops.mean()) * speed_ratio
    shares = [_sampling(slabs, drops), _ends(drops, flat, speed_ratio), _mesh(slabs, value)]
    known = tuple(
        Share(share.name, share.half_width * (value if share.name == _SAMPLE else 1.0), share.source)
        for share in shares
        if share is not None
    )
    half = math.sqrt(sum(share.half_width**2 for share in known))
    medium = ThickMedium(
        thickness=thickness,
        face_velocity=face_velocity,
        pressure_drop=value,
        low=max(value - half, 0.0),
        high=value + half,
        shares=known,
        slabs=len(slabs),
        slab_thickness=float(np.mean([slab.thickness for slab in slabs])),
        by_proportion=float(flat.mean()) * speed_ratio,
    )
    return medium if capture is None or speed_ratio != 1.0 else _with_penetration(medium, slabs[0], capture)


_SAMPLE = "another piece of the medium"


def _sampling(slabs: Sequence[Slab], drops: Floats) -> Share | None:
    """How well the slabs stand for the medium, relative, at 95 %."""
    if len(slabs) >= _FEW:
        half = _student(len(slabs)) * float(drops.std(ddof=1)) / math.sqrt(len(slabs)) / float(drops.mean())
        return Share(_SAMPLE, half, f"the scatter of {len(slabs)} slabs")
    found = []
    spreads = [slab.seed_spread for slab in slabs if slab.seed_spread is not None]
    if spreads:
        half = 2.0 * float(np.mean(spreads)) / math.sqrt(len(slabs))
        found.append(Share(_SAMPLE, half, "the spread of seeds, as it was measured on other mats"))
    layers = np.array(slabs[0].layers)
    if len(layers) >= _FEW:
        half = _student(len(layers)) * float(layers.std(ddof=1)) / math.sqrt(len(layers)) / float(layers.mean())
        found.append(Share(_SAMPLE, half, f"the scatter of {len(layers)} layers within the slab"))
    # neither sees all of it: layers share their plan, and other mats are not this one
    return max(found, key=lambda share: share.half_width, default=None)


def _ends(drops: Floats, flat: Floats, speed_ratio: float) -> Share:
    half = abs(float(drops.mean() - flat.mean())) * speed_ratio
    return Share("the slab's ends", half, "inner gradient against drop over thickness")


def _mesh(slabs: Sequence[Slab], value: float) -> Share | None:
    errors = [max(map(abs, slab.mesh_error)) for slab in slabs if slab.mesh_error is not None]
    return Share("the mesh", max(errors) * value, "meshes of this edge on other mats") if errors else None


def _student(count: int) -> float:
    from scipy.special import stdtrit

    return float(stdtrit(count - 1, 0.975))


def _with_penetration(medium: ThickMedium, slab: Slab, found: Capture) -> ThickMedium:
    times = 1.0 + slab.solid_ratio * (medium.thickness - slab.thickness) / slab.thickness

    def through(efficiency: Sequence[float]) -> tuple[float, ...]:
        return tuple(float((1.0 - each) ** times) for each in efficiency)

    return replace(
        medium,
        particle_diameter=found.particle_diameter,
        penetration=through(found.efficiency),
        penetration_low=through(found.high),
        penetration_high=through(found.low),
    )
