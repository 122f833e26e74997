"""Whether the air of a mesh can flow: in one piece, from the inlet to the outlet."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.errors import StageError
from pipeline.geometry.parts import parts
from pipeline.geometry.tets import volumes
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.patches import INLET, OUTLET


def refuse_blocked(points: Floats, tets: Ints, triangles: dict[str, Ints], unit: float, origin: Floats) -> None:
    """Refuse a mesh that has no way through, or air that no way leads to.

    Parameters
    ----------
    points : (n, 3) array
    tets : (m, 4) int array
    triangles : dict of (b, 3) int array
        By patch.
    unit : float [m]
        Of the points.
    origin : (3,) array [m]

    Raises
    ------
    StageError
        If a cell is inside out, a patch is missing, inlet and outlet are not joined, or a pocket is cut off.
    """

    def place(where: Floats) -> str:
        return "({:.4g}, {:.4g}, {:.4g}) um".format(*(1e6 * (origin + unit * where)))

    size = volumes(points, tets)
    inverted = np.flatnonzero(size <= 0.0)
    if len(inverted):
        raise StageError(
            f"{len(inverted)} of {len(tets)} tetrahedra are inside out, first {inverted[0]} at "
            f"{place(points[tets[inverted[0]]].mean(axis=0))}: mesh again with a smaller tetmesh.edge"
        )
    for name in (INLET, OUTLET):
        if not len(triangles.get(name, ())):
            raise StageError(f"the mesh has no {name}: air has to enter and to leave; its patches are named wrongly")
    # vertices joined by the edges of cells; air that touches in a vertex or an edge only is rare, and not told apart
    count = len(points)
    row, column = tets[:, [0, 0, 0]].ravel(), tets[:, 1:].ravel()
    _, part = parts(row, column, count)
    through = set(part[triangles[INLET]].ravel().tolist()) & set(part[triangles[OUTLET]].ravel().tolist())
    if not through:
        raise StageError(
            "the fibers close the duct: no air leads from the inlet to the outlet; take a mat of less solidity, "
            "or a smaller tetmesh.edge if gaps are lost"
        )
    lost = np.flatnonzero(~np.isin(part[tets[:, 0]], list(through)))
    if len(lost):
        pockets = np.unique(part[tets[lost, 0]])
        share = float(size[lost].sum() / size.sum())
        raise StageError(
            f"{len(pockets)} pockets of {len(lost)} tetrahedra ({100 * share:.2g} % of the air) are cut off, the first "
            f"at {place(points[tets[lost[0]]].mean(axis=0))}: mesh again with a smaller tetmesh.edge"
        )
