"""Air that slips along fibers of about its mean free path: a velocity on the wall that is a share of the cell's."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.nouns.arrays import Floats
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS
from pipeline.openfoam.foam_file import format_scalars


@dataclass(frozen=True, eq=False, slots=True)
class FiberSlip:
    r"""How far the air slips along the fibers.

    Parameters
    ----------
    length : float [m]
        Slip length :math:`\lambda_s`: tangential velocity over shear rate at the wall.
    radius : float or (faces of the fibers' patch,) array [m]
        Of the fiber at each face.

    Notes
    -----
    OpenFOAM v1912 has no Maxwell condition for incompressible flow. `partialSlip` with the fraction
    :math:`f = \delta / (\delta + L)`, :math:`\delta` the distance of the cell's center from the face, is the same on
    a plane wall for :math:`L = \lambda_s`. Around a cylinder the shear rate is
    :math:`\partial u_\theta / \partial r - u_\theta / r`, which makes it :math:`L = \lambda_s / (1 + \lambda_s / r)`;
    without that term the pressure drop of an array is 10 % off at :math:`\lambda_s = 0.25\,r`.
    """

    length: float
    radius: float | Floats

    def fractions(self, mesh: FaceMesh) -> Floats:
        """Share of the wall in the velocity on each face of the fibers: 1 for no slip, 0 for no friction."""
        patch = next(patch for patch in mesh.patches if patch.name == FIBERS)
        faces = slice(patch.start, patch.start + patch.count)
        shape = mesh.polyhedra()
        normal = shape.areas[faces] / np.linalg.norm(shape.areas[faces], axis=1)[:, None]
        distance = np.einsum("ij,ij->i", normal, shape.centers[faces] - shape.cell_centers[mesh.owner[faces]])
        length = self.length / (1.0 + self.length / np.broadcast_to(self.radius, distance.shape))
        fraction: Floats = distance / (distance + length)
        return fraction

    def condition(self, mesh: FaceMesh) -> str:
        """Entries of the fibers' boundary condition."""
        fractions = format_scalars(self.fractions(mesh), "ascii").decode().strip()
        return f"type partialSlip; valueFraction nonuniform List<scalar> {fractions};"


def fiber_radius(mesh: FaceMesh, radius: Floats) -> float | Floats:
    """Give the radius of the fiber at each face of the fibers' patch.

    Parameters
    ----------
    mesh : FaceMesh
        Whose wall faces name their fiber.
    radius : (fibers,) array [m]
        Of each fiber of the mat.

    Returns
    -------
    float or (faces of the fibers' patch,) array [m]
        One number where all fibers are as thick.
    """
    radii = np.unique(radius)
    if len(radii) == 1:
        return float(radii[0])
    of_faces: Floats = radius[mesh.fiber]
    return of_faces
