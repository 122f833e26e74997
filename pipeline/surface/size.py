"""How large a mat's surface will be: told before it is made, and refused where it cannot fit."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.errors import StageError
from pipeline.machine import free_memory
from pipeline.nouns.arrays import Floats
from pipeline.nouns.fibers import Mat
from pipeline.surface.settings import SurfaceSettings

MEMORY_PER_TRIANGLE = 1700.0
"""What the stage holds at its peak [byte]: 1.3 GB for the 780,000 triangles of Fig. 10."""

SECONDS_PER_TRIANGLE = 2.5e-5
"""What the stage takes on one core [s]: 20 s for the same."""


def expected_triangles(mat: Mat, settings: SurfaceSettings) -> Floats:
    """Estimate how many triangles the tube of each fiber has before it is united, (fibers,) array.

    Examples
    --------
    >>> from pipeline.mat.generate import generate
    >>> from pipeline.mat.settings import ArraySettings
    >>> one = generate(ArraySettings(arrangement="square", solidity=0.1, fiber_diameter=1e-6, depth=6e-6))
    >>> expected_triangles(one, SurfaceSettings(sides=10, ring_spacing=0.6)).tolist()
    [200.0]
    """
    fiber = mat.segment_fibers()
    bands = np.maximum(1.0, np.rint(mat.segment_lengths() / (2.0 * settings.ring_spacing * mat.radius[fiber])))
    each: Floats = 2.0 * settings.sides * np.bincount(fiber, bands, mat.fibers).astype(np.float64)
    return each


def refuse_too_large(mat: Mat, settings: SurfaceSettings) -> float:
    """Give the triangles that are to be expected.

    Raises
    ------
    StageError
        If they would not fit into the machine's free memory, with the fibers that most of them belong to.
    """
    each = expected_triangles(mat, settings)
    total, free = float(each.sum()), float(free_memory())
    needed = total * MEMORY_PER_TRIANGLE
    if needed > free:
        most = int(np.argmax(each))
        raise StageError(
            f"the surface would have about {total:.2g} triangles and take {needed / 2**30:.3g} GiB of the "
            f"{free / 2**30:.3g} GiB that are free; fiber {most} alone, {2e6 * mat.radius[most]:.3g} um thick, "
            f"takes {each[most] / total:.0%} of them: raise surface.ring_spacing, lower surface.sides, or leave fibers "
            "out that are far thinner than the others"
        )
    return total
