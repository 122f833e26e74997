"""From distances in voxels to the sizes of pores, the way through them, and how crooked it is."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.geometry.conduction import conductance_through, open_volumes
from pipeline.geometry.pores import Spheres, mean_flow_radius, spheres_in
from pipeline.nouns.arrays import Floats
from pipeline.nouns.structure import PoreSizes, SpecificSurface, Structure
from pipeline.progress import Progress, silent
from pipeline.structure.voxels import Room

_STEPS = 40  # sizes that the distribution is told at
_SOLVED = 2_000_000  # voxels beyond which conduction is solved on every second one: multigrid takes 2 kB a voxel
_WIDEST = 40.0
"""Voxels to the radius of the largest sphere, at most: finer voxels tell nothing, and cost by their sixth power."""
_FLOW_STEP = 2  # voxels to one of the tubes' flow, whose model is coarser than its voxels


def structure_of(
    room: Room, periodic: bool, surface: SpecificSurface | None = None, progress: Progress = silent
) -> Structure:
    r"""Measure the pores of a medium.

    Parameters
    ----------
    room : Room
    periodic : bool
        Whether the sides wrap; else the medium goes on as its mirror image.
    surface : SpecificSurface, optional
    progress : Progress

    Returns
    -------
    Structure

    Notes
    -----
    The relative diffusivity is that of :math:`\nabla^2 c = 0` in the air with walls that nothing enters; the
    tortuosity factor is :math:`\tau = \varepsilon D_0 / D_\mathrm{eff}` (Epstein 1989,
    doi 10.1016/0009-2509(89)85053-5; 1 for straight tubes along z).
    """
    distance, voxel = room.distance, room.voxel
    progress("spheres between the fibers", 0.1)
    porosity = float(open_volumes(distance).mean())
    held, width = _every(distance, math.ceil(float(distance.max()) / _WIDEST))
    spheres = spheres_in(held, periodic)
    progress("diffusion through the pores", 0.4)
    step = math.ceil((distance.size / _SOLVED) ** (1 / 3))
    coarse, _ = _every(distance, step)
    through = conductance_through(np.ones(coarse.shape), coarse, periodic)
    diffusivity = min(through * coarse.shape[2] / (coarse.shape[0] * coarse.shape[1]), 1.0)
    progress("the mean flow pore", 0.7)
    again = math.ceil((held.size / _SOLVED) ** (1 / 3))
    flow = mean_flow_radius(spheres, again if width > 1 else _FLOW_STEP * again)
    return Structure(
        voxel=voxel,
        voxels=(distance.shape[0], distance.shape[1], distance.shape[2]),
        porosity=porosity,
        pores=_sizes(spheres, open_volumes(held), voxel * width),
        bubble_point=2.0 * voxel * width * spheres.passing,
        mean_flow_pore=2.0 * voxel * width * flow,
        specific_surface=surface,
        relative_diffusivity=diffusivity,
        tortuosity=porosity / diffusivity if diffusivity > 0.0 else 0.0,
    )


def _every(distance: Floats, step: int) -> tuple[Floats, int]:
    """Give the distance at every so many voxels, in those wider voxels, and how wide they are; 1 or more."""
    step = max(step, 1)
    return distance[(slice(step // 2, None, step),) * 3] / step, step


def _sizes(spheres: Spheres, open_share: Floats, voxel: float) -> PoreSizes:
    """Sizes of pores, by the volume of air: a voxel that a wall cuts counts in part."""
    held = (spheres.thickness > 0.0) & (open_share > 0.0)
    diameter, weight = 2.0 * voxel * spheres.thickness[held], open_share[held]
    order = np.argsort(diameter)
    diameter, weight = diameter[order], weight[order]
    below = (np.cumsum(weight) - 0.5 * weight) / weight.sum()
    mean = float(np.average(diameter, weights=weight))
    at = np.linspace(0.0, float(diameter[-1]), _STEPS)
    smaller = np.concatenate([[0.0], np.cumsum(weight)])[np.searchsorted(diameter, at)]
    tenth, half, most = np.interp([0.1, 0.5, 0.9], below, diameter)
    return PoreSizes(
        mean=mean,
        std=math.sqrt(float(np.average((diameter - mean) ** 2, weights=weight))),
        median=float(half),
        p10=float(tenth),
        p90=float(most),
        largest=float(diameter[-1]),
        diameter=tuple(at.tolist()),
        share=tuple((1.0 - smaller / weight.sum()).tolist()),
    )
