"""The one way from loose to tight: less spacing first, then limper fibers, then less spacing still."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator

from pipeline.mat.settings import LayeredSettings

SLOPES = (0.0, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.45, 0.7, 1.0)
"""Relaxation slopes [-] at which a search looks first."""

SPACINGS = (10.0, 3.0, 1.0, 0.3, 0.1, 0.0)
"""Spacings at which a search looks first, in mean fiber diameters."""

Place = tuple[float, float]
"""Relaxation slope [-] and spacing [m]."""


def stretches(settings: LayeredSettings, keep: frozenset[str]) -> Iterator[tuple[Place, ...]]:
    """Give the stretches of the way, each with the places to look at first, the likeliest stretch first.

    Parameters
    ----------
    settings : LayeredSettings
        Whose spacing is left alone as long as the slope will do.
    keep : frozenset of str
        ``relaxation_slope`` or ``spacing``: what must stay as the settings have it.
    """
    slope, spacing = settings.relaxation_slope, settings.spacing
    gaps = [share * settings.fiber_diameter.mean for share in SPACINGS]
    if "relaxation_slope" not in keep:
        yield tuple((each, spacing) for each in SLOPES)
    if "spacing" not in keep:
        wider = [gap for gap in gaps if gap > spacing]
        tighter = [gap for gap in gaps if gap < spacing]
        low, high = (slope, slope) if "relaxation_slope" in keep else (SLOPES[0], SLOPES[-1])
        if wider:
            yield ((low, spacing), *((low, gap) for gap in reversed(wider)))
        if tighter:
            yield ((high, spacing), *((high, gap) for gap in tighter))


def between(first: Place, second: Place, share: float) -> Place:
    """Give the place that lies the given share of the way from one to another, rounded as a case file shows it."""
    slope, spacing = (a + share * (b - a) for a, b in zip(first, second, strict=True))
    return float(f"{slope:.4g}"), float(f"{spacing:.4g}")
