"""The air that flows, and what a solver found."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

from pipeline.nouns.arrays import require


@dataclass(frozen=True, slots=True)
class Flow:
    """Air on its way into the duct.

    Parameters
    ----------
    face_velocity : float [m/s]
        Flow rate over the face's area.
    temperature : float [K]
    viscosity : float [Pa s]
        Dynamic.
    density : float [kg/m3]
    mean_free_path : float [m]
    """

    face_velocity: float
    temperature: float
    viscosity: float
    density: float
    mean_free_path: float

    def __post_init__(self) -> None:
        for name in ("face_velocity", "temperature", "viscosity", "density", "mean_free_path"):
            require(getattr(self, name) > 0, f"{name} is not above 0")


@dataclass(frozen=True, slots=True)
class Solution:
    """What a solver found for the flow through a duct.

    Parameters
    ----------
    pressure_drop : float [Pa]
        Mean over the inlet less mean over the outlet.
    flow_rate : float [m3/s]
        Into the inlet.
    drag : float [N]
        Of the air on the fibers, along the flow.
    permeability : float [m2]
        Darcy's, over the mat's thickness: viscosity x velocity x thickness / pressure drop.
    force_balance_error : float [-]
        Drag over (pressure drop x face area), less 1: nothing else holds the air back where the sides are planes of
        symmetry. The engine `stokes` adds to the drag what momentum the air gained on its way.
    mass_balance_error : float [-]
        Flow out over flow in, less 1.
    iterations : int
    converged : bool
        Whether the pressure drop had settled when the run ended.
    effective_fiber_diameter : float [m], optional
        Diameter for which the model the user chose gives this pressure drop at the mesh's solidity.
    f_star : float [-], optional
        For an array of parallel cylinders: drag per length of fiber over viscosity x face velocity.
    engine : str
        Solver that found it, as ``solve.engine`` names it.
    fiber_wall : str
        What the air does on the fibers: ``slip`` or ``no_slip``.
    pressure_drop_error : float [-], optional
        Of the iterations, relative; the mesh's own is not in it.
    pressure_drop_no_slip, pressure_drop_slip : float [Pa], optional
        With either wall; None where that was not solved.
    other_wall : str, optional
        How the drop with the other wall was found.
    inertia : bool, optional
        Whether the air had inertia in the equations that were solved; None where that is not known.
    pressure_drop_creeping : float [Pa], optional
        Without inertia, with the wall as it is; None where only one of the two was solved.
    drag_per_fiber : tuple of float [N]
        Along the flow, in the order of ``mat/fibers.csv``; empty where the engine does not tell.
    reynolds : float [-], optional
        Face velocity x mean fiber diameter x density over viscosity.
    mach : float [-], optional
        Face velocity over the speed of sound.
    knudsen : float [-], optional
        Mean free path over mean fiber radius.
    regime : str, optional
        Flow regime that it belongs to.
    wall_edges, straight_wall_edges : int, optional
        Edges of the mesh on fibers, and those of them that are not curved onto the true fibers.
    mesh_error : tuple of 3 floats [-], optional
        Mean, lowest and highest error, relative, of pressure drops on meshes of this edge, mesher and solver, measured
        on other mats; None where that was not measured.
    seed_spread : float [-], optional
        Standard deviation over seeds, relative, as measured on other mats scales to this plan; None for a mat that no
        seed draws, and for plans unlike the measured.
    """

    pressure_drop: float
    flow_rate: float
    drag: float
    permeability: float
    force_balance_error: float
    mass_balance_error: float
    iterations: int
    converged: bool
    effective_fiber_diameter: float | None = None
    f_star: float | None = None
    engine: str = "openfoam"
    fiber_wall: str = "no_slip"
    pressure_drop_error: float | None = None
    pressure_drop_no_slip: float | None = None
    pressure_drop_slip: float | None = None
    other_wall: str | None = None
    inertia: bool | None = None
    pressure_drop_creeping: float | None = None
    drag_per_fiber: tuple[float, ...] = ()
    reynolds: float | None = None
    mach: float | None = None
    knudsen: float | None = None
    regime: str | None = None
    wall_edges: int | None = None
    straight_wall_edges: int | None = None
    mesh_error: tuple[float, float, float] | None = None
    seed_spread: float | None = None

    @property
    def inertia_words(self) -> str:
        """What was done about inertia."""
        if not self.inertia:
            return "solved as creeping flow: inertia would change less than 0.5 %"
        if self.pressure_drop_creeping is None:
            return "solved with inertia"
        return (
            f"solved with inertia, which adds {self.pressure_drop / self.pressure_drop_creeping - 1.0:.2g} of the drop"
        )


@dataclass(frozen=True, slots=True)
class SolvingCost:
    """What a solution cost: kept beside it, since equal solutions differ in it.

    Parameters
    ----------
    seconds : float [s]
        Wall time of all runs that led to it.
    cores : int
        Threads, or processes, that shared the work.
    peak_memory : int [byte], optional
        Most that the process held; None where others solved.
    kept_iterations: int
        That were taken over from runs which were stopped.
    """

    seconds: float
    cores: int
    peak_memory: int | None = None
    kept_iterations: int = 0


@dataclass(frozen=True, slots=True)
class Curve:
    """A pressure drop on its way to where it settled.

    Parameters
    ----------
    fiber_wall : str
        What the air does on the fibers: ``slip`` or ``no_slip``.
    iterations : tuple of int
        At which it was looked at.
    pressure_drop : tuple of float [Pa]
    """

    fiber_wall: str
    iterations: tuple[int, ...]
    pressure_drop: tuple[float, ...]

    def __post_init__(self) -> None:
        require(len(self.iterations) == len(self.pressure_drop), "not every iteration has its pressure drop")


@dataclass(frozen=True, slots=True)
class Settling:
    """How a solution settled: one curve for each wall that was solved, in the order of solving."""

    curves: tuple[Curve, ...]
