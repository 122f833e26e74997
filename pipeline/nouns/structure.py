"""What the air between the fibers is like: pores, surface, and the way through."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

from pipeline.nouns.arrays import require


@dataclass(frozen=True, slots=True)
class PoreSizes:
    """Diameters of the largest spheres that fit into the air, by the volume that they fill.

    Parameters
    ----------
    mean, std, median : float [m]
        Weighted by volume.
    p10, p90 : float [m]
        Diameters below which a tenth, and nine tenths, of the air's volume lie.
    largest : float [m]
    diameter : tuple of float [m]
        At which the distribution is told, ascending.
    share : tuple of float [-]
        Share of the air's volume in spheres of at least this diameter.
    """

    mean: float
    std: float
    median: float
    p10: float
    p90: float
    largest: float
    diameter: tuple[float, ...]
    share: tuple[float, ...]

    def __post_init__(self) -> None:
        require(len(self.diameter) == len(self.share), "not every diameter has its share")
        require(0.0 < self.mean <= 1.000001 * self.largest, "a mean pore is 0, or beyond the largest")


@dataclass(frozen=True, slots=True)
class SpecificSurface:
    """Surface of the fibers, without what the plan's sides cut.

    Parameters
    ----------
    per_volume : float [m2/m3]
        Over the slab's volume.
    per_solid : float [m2/m3]
        Over the fibers' own volume.
    per_mass : float [m2/kg], optional
        Over the fibers' mass; None where nobody says how dense they are.
    """

    per_volume: float
    per_solid: float
    per_mass: float | None = None


@dataclass(frozen=True, slots=True)
class Structure:
    """The pores of a medium and what follows from them, in its slab.

    Parameters
    ----------
    voxel : float [m]
        Edge of the cubes that it was measured on.
    voxels : tuple of 3 int
        Along x, y and z.
    porosity : float [-]
        Of the voxels.
    pores : PoreSizes
    bubble_point : float [m]
        Diameter of the largest sphere that passes through along z; 0 where none does.
    mean_flow_pore : float [m]
        Diameter of the sphere that enters what carries half of the dry flow, of air that flows as through tubes of the
        inscribed spheres; 0 where nothing passes.
    specific_surface : SpecificSurface, optional
        None of voxels, whose steps have more surface than what they stand for.
    relative_diffusivity : float [-]
        Of a gas along z in the air between the fibers, over that in free air: effective over bulk diffusivity.
    tortuosity : float [-]
        Diffusive tortuosity factor: porosity over the relative diffusivity; 0 where nothing passes.
    """

    voxel: float
    voxels: tuple[int, int, int]
    porosity: float
    pores: PoreSizes
    bubble_point: float
    mean_flow_pore: float
    specific_surface: SpecificSurface | None
    relative_diffusivity: float
    tortuosity: float

    def __post_init__(self) -> None:
        require(0.0 < self.porosity < 1.0, "the porosity is not between 0 and 1")
        require(0.0 <= self.relative_diffusivity <= 1.0, "a gas diffuses faster than in free air, or backward")
