"""Fill the crevices that no mesh resolves, and drop the pockets that no flow reaches.

Where a fiber grazes a side of the duct, or two fibers touch, the air ends in a wedge without thickness. The cells in
its tip have all their vertices on the boundary, so that none can be moved, and no shape of theirs suits a solver.
The air in them stands still: they are given to the fibers, a few millionths of the air.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.nouns.arrays import Ints


def in_crevice(
    tets: Ints, walls: Ints, at_wall: Ints, vertices: int, faulty: npt.NDArray[np.bool_], stuck: bool
) -> npt.NDArray[np.bool_]:
    """Find the faulty cells that lie in the tip of a wedge.

    Parameters
    ----------
    tets : (m, 4) int array
    walls : (b, 3) int array
        Faces on the boundary.
    at_wall : (b,) int array
        Cell of each.
    vertices : int
        Number of vertices.
    faulty : (m,) bool array
        Cells that a solver would find fault with.
    stuck : bool
        Whether mending has given up: then every faulty cell with a face on the boundary is in a tip; before, only
        those whose every vertex lies on the boundary too.

    Returns
    -------
    (m,) bool array
    """
    touching = np.zeros(len(tets), dtype=bool)
    touching[at_wall] = True
    tip: npt.NDArray[np.bool_] = faulty & touching
    if not stuck:
        on_boundary = np.zeros(vertices, dtype=bool)
        on_boundary[walls] = True
        tip &= on_boundary[tets].all(axis=1)
    return tip
