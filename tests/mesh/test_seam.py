"""Part of a mesh that is worked on alone fits the rest afterwards: no vertex hangs on a face, no wall is in the air.

An edge on the seam that was split on one side only left two walls within the air; they made the next cells faulty, and
the mesh doubled from pass to pass (the default case, seed 3).
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.adjacency import neighbors
from pipeline.geometry.tets import FACES, boundary, volumes
from pipeline.geometry.triangles import area_vectors
from pipeline.mesh.improve.corners import split_corners, split_longest
from pipeline.nouns.arrays import Floats, Ints
from tests.mesh.boxes import kuhn_box


def parted(seed: int) -> tuple[Floats, Ints, Ints, Ints]:
    """A cube in tetrahedra, those of a random part and the rest, and the faces between them."""
    points, tets = kuhn_box(4)
    rng = np.random.default_rng(seed)
    center = rng.uniform(0.2, 0.8, 3)
    near = np.linalg.norm(points[tets].mean(axis=1) - center, axis=1) < rng.uniform(0.25, 0.45)
    across = neighbors(tets)
    cell, side = np.nonzero((across >= 0) & near[:, None])
    out = ~near[across[cell, side]]
    seam = np.sort(np.take_along_axis(tets[cell[out]], FACES[side[out]], axis=1), axis=1)
    return points, tets[near], tets[~near], seam


@pytest.mark.parametrize("seed", range(12))
def test_splitting_a_part_leaves_no_wall_in_the_air(seed: int) -> None:
    points, part, rest, seam = parted(seed)
    points, part = split_corners(points, part, seam)
    rng = np.random.default_rng(seed)
    for _ in range(3):
        points, part = split_longest(points, part, rng.random(len(part)) < 0.5, seam)
        points, part = split_corners(points, part, seam)
    whole = np.concatenate([rest, part])
    assert len(part) > 1.5 * (4**3 * 6 - len(rest))  # something was split
    assert volumes(points, whole).min() > 0.0
    assert volumes(points, whole).sum() == pytest.approx(1.0, rel=1e-12)
    faces, _ = boundary(whole)
    # the cube's own sides, and nothing else
    assert np.linalg.norm(area_vectors(points, faces), axis=1).sum() == pytest.approx(6.0, rel=1e-12)
