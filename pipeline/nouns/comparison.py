"""Pressure drops by analytical models, side by side."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class ModelRow:
    """Pressure drop by one model, from three solidities [Pa].

    Parameters
    ----------
    nominal, surface, mesh : float [Pa]
        From the nominal, the surface's and the mesh's solidity; infinite where the model has no answer.
    overlap, meshing : float [Pa]
        What the fibers' overlap takes (surface less nominal) and what the mesh takes (mesh less surface).
    title, structure : str
        Whose model, of what kind of medium.
    notes : tuple of str
        What is outside the model's range.
    """

    nominal: float
    surface: float
    mesh: float
    overlap: float = 0.0
    meshing: float = 0.0
    title: str = ""
    structure: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Comparison:
    """Pressure drop by analytical models from three solidities, side by side.

    Parameters
    ----------
    solidity : dict of str to float [-]
        ``nominal``, ``surface``, ``mesh``.
    thickness, fiber_diameter : float [m]
        Of the slab; the diameter of equal fibers that have the same length and volume.
    face_velocity : float [m/s]
    models : dict of str to ModelRow
    knudsen, reynolds : float [-]
        Of the fiber.
    regime : str
        Flow regime of the fiber.
    attribution : dict of str to float [-]
        Relative changes of the reference model's pressure drop: by ``overlap``, by ``meshing``, and by taking the
        lowest (``model_low``) or the highest (``model_high``) of all models instead.
    fiber_diameters : dict of str to float [m]
        Mean diameters of the mat, by what each of them keeps.
    """

    solidity: dict[str, float]
    thickness: float
    fiber_diameter: float
    face_velocity: float
    models: dict[str, ModelRow] = field(default_factory=dict)
    knudsen: float = 0.0
    reynolds: float = 0.0
    regime: str = ""
    attribution: dict[str, float] = field(default_factory=dict)
    fiber_diameters: dict[str, float] = field(default_factory=dict)
