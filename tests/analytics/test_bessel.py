"""Our own Bessel functions and roots against scipy's."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import k0e, k1e

from pipeline.analytics.formulas.bessel import scaled_bessel_ratio
from pipeline.analytics.formulas.spielman_goren import spielman_goren_isotropic, spielman_goren_layers


@pytest.mark.parametrize("x", np.geomspace(1e-19, 1e5, 49).tolist())
def test_the_ratio_of_bessel_functions_is_scipys(x: float) -> None:
    # the smallest screening is that of a solidity of 1e-36, the largest that of a medium as good as solid
    assert scaled_bessel_ratio(x) == pytest.approx(float(k1e(x) / k0e(x)), rel=1e-12)


@pytest.mark.parametrize("solidity", [1e-12, 1e-4, 0.01, 0.05, 0.2, 0.4])
def test_the_balance_of_pressure_and_drag_is_met(solidity: float) -> None:
    # both cases without slip, as published, solved by scipy
    def stuck(xi: float) -> float:
        return float(k1e(xi) / (xi * k0e(xi)))

    layers = brentq(lambda y: np.log(4 * solidity * (0.5 + stuck(np.exp(y)))), -45, 12, xtol=1e-14)
    assert float(spielman_goren_layers(solidity)) == pytest.approx(4 * np.exp(2 * layers), rel=1e-11)
    space = brentq(lambda y: np.log(4 * solidity * (1 / 3 + 5 / 6 * stuck(np.exp(y)))), -45, 12, xtol=1e-14)
    assert float(spielman_goren_isotropic(solidity)) == pytest.approx(4 * np.exp(2 * space), rel=1e-11)
