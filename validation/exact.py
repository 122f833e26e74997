"""Exact drag of cylinders in a row: Stokes flow through periodic arrays, solved by collocation, to judge the models by.

The stream function about one cylinder of radius 1 is a series in r^(+-n), r^(+-n+2) and r ln r times sin(n theta), n
odd, that meets the cylinder's condition term by term; the symmetries of the unit cell on points of its boundary
give the rest by least squares. The drag is 4 pi times the coefficient of r ln r.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

_TERMS = 14
_POINTS = 120


def square_drag(solidity: float, slip_length: float = 0.0) -> float:
    """Drag per length over viscosity and mean velocity, F*, in a square array."""
    half = np.sqrt(np.pi / (4 * solidity))
    along = (np.arange(_POINTS) + 0.5) / _POINTS * half
    side = _rows(np.full(_POINTS, half), along, half, slip_length)
    top = _rows(along, np.full(_POINTS, half), half, slip_length)
    # the flow is the same forward and backward about x = half; y = half is a streamline that nothing shears
    system = [(side["psi_x"], 0.0), (side["omega_x"], 0.0), (top["psi"], half), (top["omega"], 0.0)]
    return _solve(system)


def hexagonal_drag(solidity: float, slip_length: float = 0.0) -> float:
    """Drag per length over viscosity and mean velocity, F*, in a hexagonal array."""
    half = np.sqrt(np.pi / (2 * np.sqrt(3) * solidity))
    height = np.sqrt(3) / 2 * half
    share = (np.arange(_POINTS) + 0.5) / _POINTS
    side = _rows(np.full(_POINTS, half), share * height, half, slip_length)
    left = _rows(share * half / 2, np.full(_POINTS, height), half, slip_length)
    right = _rows(half - share * half / 2, np.full(_POINTS, height), half, slip_length)
    # midway between two neighbours the flow looks the same turned by half a turn
    system = [
        (side["psi_x"], 0.0),
        (side["omega_x"], 0.0),
        (left["psi"] + right["psi"], 2 * height),
        (left["psi_y"] - right["psi_y"], 0.0),
        (left["omega"] + right["omega"], 0.0),
        (left["omega_y"] - right["omega_y"], 0.0),
    ]
    return _solve(system)


def _solve(system: list[tuple[Floats, float]]) -> float:
    matrix = np.vstack([rows for rows, _ in system])
    wanted = np.concatenate([np.full(len(rows), value) for rows, value in system])
    scale = np.abs(matrix).max(axis=0)
    coefficients = np.linalg.lstsq(matrix / scale, wanted, rcond=None)[0] / scale
    return float(4 * np.pi * coefficients[0])


def _rows(x: Floats, y: Floats, half: float, slip_length: float) -> dict[str, Floats]:
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    columns: dict[str, list[Floats]] = {"psi": [], "psi_r": [], "psi_t": [], "omega": [], "omega_r": [], "omega_t": []}
    for n in range(1, 2 * _TERMS, 2):
        wave, slope = np.sin(n * angle), n * np.cos(n * angle)
        for mode in _modes(n, half, slip_length):
            value, derivative, vorticity, change = mode(radius, n)
            columns["psi"].append(value * wave)
            columns["psi_r"].append(derivative * wave)
            columns["psi_t"].append(value * slope / radius)
            columns["omega"].append(vorticity * wave)
            columns["omega_r"].append(change * wave)
            columns["omega_t"].append(vorticity * slope / radius)
    polar = {name: np.column_stack(parts) for name, parts in columns.items()}
    cartesian = {"psi": polar["psi"], "omega": polar["omega"]}
    for name in ("psi", "omega"):
        cartesian[f"{name}_x"] = cos * polar[f"{name}_r"] - sin * polar[f"{name}_t"]
        cartesian[f"{name}_y"] = sin * polar[f"{name}_r"] + cos * polar[f"{name}_t"]
    return cartesian


class _Mode:
    """A sum of powers of r, and r ln r, that meets psi = 0 and the slip condition on the cylinder."""

    def __init__(self, powers: list[tuple[float, float]], logarithm: float = 0.0) -> None:
        self.powers, self.logarithm = powers, logarithm

    def __call__(self, r: Floats, n: int) -> tuple[Floats, Floats, Floats, Floats]:
        value = self.logarithm * r * np.log(r)
        derivative = self.logarithm * (np.log(r) + 1)
        vorticity = -self.logarithm * 2 / r
        change = self.logarithm * 2 / r**2
        for power, weight in self.powers:
            value = value + weight * r**power
            derivative = derivative + weight * power * r ** (power - 1)
            vorticity = vorticity - weight * (power**2 - n**2) * r ** (power - 2)
            change = change - weight * (power**2 - n**2) * (power - 2) * r ** (power - 3)
        return value, derivative, vorticity, change


def _modes(n: int, half: float, slip: float) -> list[_Mode]:
    if n == 1:
        near, far = (1.0, -1.0), (3.0,)
        logarithm = _meet(near, 0.0, 1 * (1 + slip) - slip, slip)
        return [
            _Mode([(1.0, logarithm[0]), (-1.0, logarithm[1])], 1.0),
            _power_mode(near, far[0], half, slip),
        ]
    near = (-float(n), 2.0 - n)
    return [_power_mode(near, float(n), half, slip), _power_mode(near, n + 2.0, half, slip)]


def _power_mode(near: tuple[float, float], power: float, half: float, slip: float) -> _Mode:
    size = half**-power  # keeps the columns of like size
    weights = _meet(near, size, size * (power * (1 + slip) - slip * power * (power - 1)), slip)
    return _Mode([(power, size), (near[0], weights[0]), (near[1], weights[1])])


def _meet(near: tuple[float, float], value: float, slipped: float, slip: float) -> Floats:
    # psi = 0 and (1 + s) psi' = s psi'' on r = 1: the tangential velocity is s times the shear
    matrix = np.array([[1.0, 1.0], [m * (1 + slip) - slip * m * (m - 1) for m in near]])
    return np.asarray(np.linalg.solve(matrix, [-value, -slipped]), np.float64)
