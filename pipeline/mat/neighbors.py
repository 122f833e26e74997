"""Which fibers of a mat come near each other, and how near: exact distances of center lines."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import NamedTuple

import numpy as np

from pipeline.geometry.triangles import Floats, Ints
from pipeline.nouns.fibers import Mat


class FiberPairs(NamedTuple):
    """Pairs of fibers, ``first <= second``, and the least distance of their axes [m]; a fiber pairs with its image."""

    first: Ints
    second: Ints
    distance: Floats


def near_fibers(mat: Mat, reach: Floats) -> FiberPairs:
    """Find the pairs of fibers whose axes come closer than the sum of their reaches.

    Parameters
    ----------
    mat : Mat
        In a periodic mat the fibers' images count as well, those of a fiber itself included.
    reach : (fibers,) array [m]

    Returns
    -------
    FiberPairs
        Each pair once.
    """
    from pipeline.geometry.segments import near_pairs

    start = mat.segment_starts()
    fiber = mat.segment_fibers()
    begin, end = mat.nodes[start], mat.nodes[start + 1]
    owner, shift = np.arange(mat.segments), np.zeros((mat.segments, 3))
    body = fiber
    if mat.periodic:
        owner, shift, image = _images(mat, begin, end, 2.0 * float(reach.max()))
        body = fiber[owner] + mat.fibers * image
    near = near_pairs(begin[owner] + shift, end[owner] + shift, reach[fiber[owner]], body, active=mat.segments)
    one, other = fiber[owner[near.first]], fiber[owner[near.second]]
    key = np.minimum(one, other) * mat.fibers + np.maximum(one, other)
    # the nearest of the segments' distances first, then one of each pair of fibers
    order = np.lexsort((near.distance, key))
    pairs, place = np.unique(key[order], return_index=True)
    return FiberPairs(pairs // mat.fibers, pairs % mat.fibers, near.distance[order][place])


def _images(mat: Mat, begin: Floats, end: Floats, far: float) -> tuple[Ints, Floats, Ints]:
    """Segments, and those of their images that may come near: owner, shift [m] and number of the image of each.

    Half of the shifts are enough: one fiber meets the other's image where the other meets the one's opposite image.
    """
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    size = np.array(mat.slab.size)
    wide = (high.max(axis=0) - low.min(axis=0) + far) // size
    owner, shift, image = [np.arange(mat.segments)], [np.zeros((mat.segments, 3))], [np.zeros(mat.segments, np.int64)]
    number = 0
    for i in range(int(wide[0]) + 1):
        for j in range(-int(wide[1]), int(wide[1]) + 1):
            if (i, j) <= (0, 0):
                continue
            number += 1
            move = size * (i, j, 0)
            inside = (low + move <= high.max(axis=0) + far) & (high + move >= low.min(axis=0) - far)
            near = np.flatnonzero(inside.all(axis=1))
            owner.append(near)
            shift.append(np.tile(move, (len(near), 1)))
            image.append(np.full(len(near), number))
    return np.concatenate(owner), np.concatenate(shift), np.concatenate(image)
