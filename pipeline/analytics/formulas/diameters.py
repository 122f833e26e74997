"""Which single diameter a mat of unequal fibers is entered into a model with: the candidates side by side."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

from pipeline.analytics.formulas import slip
from pipeline.analytics.formulas.cell import hydrodynamic_factor
from pipeline.nouns.arrays import Floats
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Flow


def mean_diameters(diameter: Floats, length: Floats) -> dict[str, float]:
    r"""Mean diameters of fibers, named for what equal fibers of that diameter keep of the mat.

    Parameters
    ----------
    diameter : array [m]
        Of each fiber or segment.
    length : array [m]
        Of each fiber or segment.

    Returns
    -------
    dict of str to float [m]
        ``count``: :math:`\sum d l/\sum l`, keeps length and face coverage; what a micrograph's fibers average to.
        ``volume``: :math:`\sqrt{\sum d^2 l/\sum l}`, keeps length and volume, and so the drag in models without slip.
        ``surface``: :math:`\sum d^2 l/\sum d\,l`, keeps volume and surface, as in Sauter's mean.

    Examples
    --------
    >>> import numpy as np
    >>> means = mean_diameters(np.array([1.0, 3.0]), np.array([1.0, 1.0]))
    >>> [round(means[name], 3) for name in ("count", "volume", "surface")]
    [2.0, 2.236, 2.5]
    """
    total = float(length.sum())
    first, second = float((diameter * length).sum()), float((diameter**2 * length).sum())
    return {"count": first / total, "volume": math.sqrt(second / total), "surface": second / first}


def mat_diameters(mat: Mat, flow: Flow, solidity: float) -> dict[str, float]:
    r"""Mean diameters of a mat's fibers, and the effective one.

    Parameters
    ----------
    mat : Mat
    flow : Flow
    solidity : float [-]

    Returns
    -------
    dict of str to float [m]
        ``count``, ``volume`` and ``surface`` of `mean_diameters`, and ``effective``: what Eq. A33 makes of the
        drag of all fibers added up, each in Kuwabara's cell with the slip of its own diameter.
    """
    return fiber_diameters(2.0 * mat.radius[mat.segment_fibers()], mat.inside_lengths(), flow, solidity)


def fiber_diameters(diameter: Floats, length: Floats, flow: Flow, solidity: float) -> dict[str, float]:
    """Do as `mat_diameters`, for fibers by their diameters and lengths, (n,) arrays [m]."""
    means = mean_diameters(diameter, length)
    slip_length = slip.slip_length(slip.knudsen(flow.mean_free_path, diameter))
    # F* of each fiber over that of one without slip; the drag adds up over the length
    relief = slip.kuwabara_slip(solidity, slip_length) * hydrodynamic_factor(solidity) / (16.0 * solidity)
    means["effective"] = means["volume"] / math.sqrt(float((relief * length).sum() / length.sum()))
    return means
