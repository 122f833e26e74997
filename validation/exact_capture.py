"""Exact answers for particles that diffuse from flows in channels and about fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

_PLATES = ((1.8851752, 0.9103522), (21.4315215, 0.0531425), (62.316608, 0.0152789), (124.536646, 0.0068088))
_TUBE = ((3.6568, 0.81905), (22.305, 0.09753), (56.96, 0.0325), (107.6, 0.01544))


def plates_penetration(number: float) -> float:
    """Share that passes between plates, Graetz' series; `number` is D L / (h^2 U) of half the gap, above .01."""
    return sum(factor * math.exp(-rate * number) for rate, factor in _PLATES)


def tube_penetration(number: float) -> float:
    """Share that passes a tube; `number` is pi D L / Q (Gormley and Kennedy 1949; the series below .02)."""
    if number < 0.02:
        return float(1.0 - 2.5638 * number ** (2 / 3) + 1.2 * number + 0.1767 * number ** (4 / 3))
    return sum(factor * math.exp(-rate * number) for rate, factor in _TUBE)
