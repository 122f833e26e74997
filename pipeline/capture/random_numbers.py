"""Random numbers by counting: each particle has its own stream, whatever thread draws from it and when."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.nouns.arrays import Floats

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_S30, _S27, _S31, _S11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_TO_UNIT = 2.0**-53


@compiled
def _mixed(word: np.uint64) -> np.uint64:
    word = (word ^ (word >> _S30)) * _FIRST
    word = (word ^ (word >> _S27)) * _SECOND
    return word ^ (word >> _S31)


@compiled
def stream(seed: int, size: int, particle: int) -> np.uint64:
    """Name the stream of one particle of one size.

    Parameters
    ----------
    seed, size, particle : int
        0 or more.

    Returns
    -------
    uint64

    Notes
    -----
    SplitMix64 [1]_ keyed by the three numbers; number `counter` of a stream is the mixed sum of its key and that many
    steps of the golden ratio, so any of them can be drawn without those before it.

    References
    ----------
    .. [1] G. L. Steele, D. Lea and C. H. Flood, Fast splittable pseudorandom number generators, OOPSLA 2014,
       doi:10.1145/2660193.2660195.
    """
    key = _mixed(np.uint64(seed) + _GOLDEN)
    key = _mixed(key + np.uint64(size) * _GOLDEN + _FIRST)
    return _mixed(key + np.uint64(particle) * _GOLDEN + _SECOND)


@compiled
def uniform(key: np.uint64, counter: int) -> float:
    """Give number `counter` of a stream, uniform in the open interval from 0 to 1."""
    word = _mixed(key + np.uint64(counter) * _GOLDEN)
    return (float(word >> _S11) + 0.5) * _TO_UNIT


@compiled
def normal_pair(key: np.uint64, counter: int) -> tuple[float, float]:
    """Give two independent normal numbers of mean 0 and variance 1 (Box and Muller 1958).

    They use up `counter` and `counter` + 1 of the stream.
    """
    length = math.sqrt(-2.0 * math.log(uniform(key, counter)))
    angle = 2.0 * math.pi * uniform(key, counter + 1)
    return length * math.cos(angle), length * math.sin(angle)


@compiled
def uniforms(seed: int, size: int, first: int, streams: int, count: int, counter: int) -> Floats:
    """Give numbers `counter` and following of as many streams, (streams, count) array."""
    result = np.empty((streams, count))
    for row in range(streams):
        key = stream(seed, size, first + row)
        for column in range(count):
            result[row, column] = uniform(key, counter + column)
    return result
