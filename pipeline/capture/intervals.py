"""How sure a share is that was counted."""

# SPDX-License-Identifier: GPL-3.0-or-later

CONFIDENCE = 0.95
"""Of every interval that is told."""


def share_interval(hits: int, trials: int, unknown: int = 0) -> tuple[float, float]:
    """Exact interval of a probability by Clopper and Pearson [1]_.

    Parameters
    ----------
    hits, trials : int
        0 <= hits <= trials, trials above 0.
    unknown : int
        Trials whose end is not known: no hits for the lower end, hits for the upper one.

    Returns
    -------
    low, high : float [-]
        It holds the probability in at least 95 of 100 experiments.

    References
    ----------
    .. [1] C. J. Clopper and E. S. Pearson, Biometrika 26 (1934) 404, doi:10.1093/biomet/26.4.404.

    Examples
    --------
    >>> low, high = share_interval(0, 100)
    >>> low, round(high, 4)  # 1 - .025^(1/100)
    (0.0, 0.0362)
    """
    from scipy.special import betaincinv

    tail = 0.5 * (1.0 - CONFIDENCE)
    most = hits + unknown
    low = float(betaincinv(hits, trials - hits + 1, tail)) if hits else 0.0
    high = float(betaincinv(most + 1, trials - most, 1.0 - tail)) if most < trials else 1.0
    return low, high
