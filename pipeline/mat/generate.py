"""Make a mat as its settings say."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.errors import CaseError
from pipeline.mat.array import array
from pipeline.mat.settings import ArraySettings, BoxSettings, FileSettings, LayeredSettings, SurfaceFileSettings
from pipeline.mat.sums import Predict
from pipeline.nouns.fibers import Mat
from pipeline.progress import Progress, silent


def generate(
    settings: LayeredSettings | BoxSettings | ArraySettings | FileSettings | SurfaceFileSettings,
    predict: Predict | None = None,
    progress: Progress = silent,
) -> Mat:
    """Make a fiber mat.

    Parameters
    ----------
    settings : settings of one of the generators
    predict : callable, optional
        Predicts the quantity of a stop by ``pressure_drop`` [Pa] or ``efficiency`` [-] from the solidity [-], the
        thickness [m] and the mean fiber diameter [m]; unused by other stops.
    progress : Progress

    Returns
    -------
    Mat
        The same settings give the same mat, byte by byte.

    Raises
    ------
    CaseError
        If the stop is out of reach with at most ``max_fibers`` fibers, or a file of fibers is wrong.
    ValueError
        If the stop needs `predict` and there is none.

    Examples
    --------
    >>> from pipeline.mat.settings import Stop
    >>> deposit = LayeredSettings(side=2e-5, fiber_diameter=1e-6, relaxation_slope=0.15, stop=Stop(count=10))
    >>> generate(deposit).fibers
    10
    """
    if isinstance(settings, SurfaceFileSettings):
        raise CaseError(f'generator = "surface": {settings.file} has no center lines; this command needs fibers')
    match settings:
        case ArraySettings():
            return array(settings)
        case FileSettings():
            from pipeline.mat.exchange import read_fibers

            return read_fibers(settings.file, settings.side, settings.periodic, settings.outside, progress)
    # numba takes half a second to load, which a case file's reader need not wait for
    from pipeline.mat.grow import grow

    return grow(settings, np.random.default_rng(settings.seed), predict, progress)
