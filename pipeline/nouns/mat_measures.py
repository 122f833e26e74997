"""What a mat is like, in numbers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DiameterMoments:
    """The diameters of the fibers that are there, each fiber counted once unless said otherwise.

    Parameters
    ----------
    mean, std, min, max : float [m]
    skewness : float [-]
        0 for fibers of one diameter.
    length_weighted : float [m]
        Mean with each fiber's length as its weight.
    surface_weighted : float [m]
        Sum of d^2 l over sum of d l: keeps volume and surface.
    """

    mean: float
    std: float
    min: float
    max: float
    skewness: float
    length_weighted: float
    surface_weighted: float


@dataclass(frozen=True, slots=True)
class SolidityProfile:
    """Solidity of equally thick layers of the slab.

    Parameters
    ----------
    z : tuple of float [m]
        Middle of each layer.
    solidity : tuple of float [-]
        Cylinders summed; what fibers share counts twice.
    """

    z: tuple[float, ...]
    solidity: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class MatMeasures:
    """The measures of a mat [SI]; `dataclasses.asdict` makes them fit for JSON.

    Parameters
    ----------
    fibers : int
    segments : int
        Straight pieces of all fibers.
    coverage : float [-]
        Summed plan area of the fibers over the face's area; may exceed 1.
    thickness : float [m]
        Extent of the slab: in a layered mat the highest axis plus its radius.
    solidity : float [-]
        Summed cylinder volume over the slab's volume: what fibers share counts twice.
    covered_fraction : float [-]
        Part of the face that at least one fiber covers, by a grid of eight cells to a diameter.
    robust_thickness : float [m]
        Mean, over tiles of the face one mean radius wide, of the highest surface in the tile; tiles without a fiber
        are left out.
    total_length : float [m]
        Length of all fibers.
    contacts_per_fiber : float [-]
        Other fibers that a fiber touches or overlaps, on average: surfaces at most 1 % of the radii's sum apart.
    orientation : 3 x 3 tuple of float [-]
        Mean of the outer product of the axis' direction with itself, by length; its trace is 1.
    diameters : DiameterMoments
    profile : SolidityProfile
    frame_density : float [-], optional
        Solid per plan area in the outer tenth of the plan on all sides, over that of the rest: 1 for an evenly dense
        plan. None for a periodic plan, which has no frame, and where the frame is narrower than a mean diameter.
    """

    fibers: int
    segments: int
    coverage: float
    thickness: float
    solidity: float
    covered_fraction: float
    robust_thickness: float
    total_length: float
    contacts_per_fiber: float
    orientation: tuple[tuple[float, ...], ...]
    diameters: DiameterMoments
    profile: SolidityProfile
    frame_density: float | None = None
