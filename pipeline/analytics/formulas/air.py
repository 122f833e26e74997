"""Air as a function of temperature and pressure: viscosity, density, mean free path."""

# SPDX-License-Identifier: GPL-3.0-or-later

REFERENCE_PRESSURE = 101325.0
"""Standard atmosphere [Pa]."""

COLDEST, HOTTEST = 170.0, 1900.0
"""Temperatures [K] from and to which the laws below hold to about 1 %."""
DENSEST = 1e7
"""Pressure [Pa] up to which air is an ideal gas, to some per cent at room temperature."""

_SUTHERLAND = 110.4  # Sutherland's temperature of air, K
_SUTHERLAND_FACTOR = 1.458e-6  # kg/(m s K^0.5)
_GAS_CONSTANT = 287.053  # of dry air, J/(kg K)
_HEAT_RATIO = 1.4  # of the specific heats of air
_FREE_PATH = 65.3e-9  # m, at the temperature below and REFERENCE_PRESSURE
_FREE_PATH_TEMPERATURE = 293.0  # K


def viscosity(temperature: float) -> float:
    r"""Dynamic viscosity of air, Eq. A20: Sutherland's law with the constants of the standard atmosphere [1]_.

    .. math:: \eta = \frac{1.458\cdot 10^{-6}\,T^{3/2}}{T + 110.4}

    Parameters
    ----------
    temperature : float [K]
        Good to about 1 % from 170 to 1900 K.

    Returns
    -------
    float [Pa s]

    References
    ----------
    .. [1] U.S. Standard Atmosphere, 1976, Eq. 51. The same law as Eq. A20 of the source paper, whose Table A6
       prints 1.813e-5 Pa s at 293 K.

    Examples
    --------
    >>> f"{viscosity(293.0):.3e}"
    '1.813e-05'
    """
    return float(_SUTHERLAND_FACTOR * temperature**1.5 / (temperature + _SUTHERLAND))


def density(temperature: float, pressure: float = REFERENCE_PRESSURE) -> float:
    r"""Density of dry air as an ideal gas, :math:`\rho = p / (R T)` with R = 287.053 J/(kg K).

    Parameters
    ----------
    temperature : float [K]
    pressure : float [Pa]
        Within 0.1 % of real air near room conditions.

    Returns
    -------
    float [kg/m3]

    Examples
    --------
    >>> round(density(293.0), 1)
    1.2
    """
    return pressure / (_GAS_CONSTANT * temperature)


def sound_speed(temperature: float) -> float:
    r"""Speed of sound in air as an ideal gas, :math:`c = \sqrt{1.4 R T}` with R = 287.053 J/(kg K).

    Parameters
    ----------
    temperature : float [K]

    Returns
    -------
    float [m/s]

    Examples
    --------
    >>> round(sound_speed(293.15), 1)
    343.2
    """
    return float((_HEAT_RATIO * _GAS_CONSTANT * temperature) ** 0.5)


def mean_free_path(temperature: float, pressure: float = REFERENCE_PRESSURE) -> float:
    r"""Mean free path of air, scaled from the source paper's 65.3 nm by Willeke's law [1]_.

    .. math:: \lambda = 65.3\,\mathrm{nm}\;\frac{T}{293\,\mathrm{K}}\;\frac{101325\,\mathrm{Pa}}{p}\;
              \frac{1 + 110.4/293}{1 + 110.4/T}

    Parameters
    ----------
    temperature : float [K]
    pressure : float [Pa]

    Returns
    -------
    float [m]

    Notes
    -----
    Table A6 prints 65.3 nm at 293 K, its text "approximately 65 nm". Other sources give 66 to 67.3 nm there;
    set ``flow.mean_free_path`` to use one of them.

    References
    ----------
    .. [1] K. Willeke, Temperature dependence of particle slip in a gaseous medium, J. Aerosol Sci. 7 (1976) 381-387.

    Examples
    --------
    >>> mean_free_path(293.0)
    6.53e-08
    """
    warmth = (1.0 + _SUTHERLAND / _FREE_PATH_TEMPERATURE) / (1.0 + _SUTHERLAND / temperature)
    return _FREE_PATH * (temperature / _FREE_PATH_TEMPERATURE) * (REFERENCE_PRESSURE / pressure) * warmth
