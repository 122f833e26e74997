"""Pressure drop by every model from the nominal, the surface's and the mesh's solidity, and where they differ."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.analytics.formulas import slip
from pipeline.analytics.formulas.cell import reynolds
from pipeline.analytics.formulas.diameters import fiber_diameters, mat_diameters
from pipeline.analytics.formulas.pressure_drop import pressure_drop
from pipeline.analytics.models.pressure_models import MODELS, PressureModel
from pipeline.nouns.comparison import Comparison, ModelRow
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Flow

REFERENCE = "davies"
"""The model that the parts of a comparison are told of: the paper's choice."""


def nominal_solidity(mat: Mat) -> float:
    """Volume of all the fibers' cylinders within the plan over the slab's volume, overlaps counted twice [-]."""
    section = math.pi * mat.radius[mat.segment_fibers()] ** 2
    return float((section * mat.inside_lengths()).sum()) / mat.slab.volume


def compare(mat: Mat, surface_solidity: float, mesh_solidity: float, flow: Flow) -> Comparison:
    """Predict the pressure drop of one mat from three solidities with every model.

    Parameters
    ----------
    mat : Mat
    surface_solidity : float [-]
        Of the united surface, over the slab.
    mesh_solidity : float [-]
        1 minus the mesh's air over the slab.
    flow : Flow

    Returns
    -------
    Comparison
        Models without an answer at one of the solidities are left out. In each row, nominal + overlap + meshing =
        mesh. ``attribution`` tells the same of `REFERENCE` in relative terms, beside the spread of all models that
        are within their solidity range.
    """
    solidity = {"nominal": nominal_solidity(mat), "surface": surface_solidity, "mesh": mesh_solidity}
    return _compared(solidity, mat_diameters(mat, flow, mesh_solidity), mat.thickness, flow)


def compare_body(
    thickness: float, diameter: float, surface_solidity: float, mesh_solidity: float, flow: Flow
) -> Comparison:
    """Predict the pressure drop of a medium whose fibers' axes nobody knows.

    Parameters
    ----------
    thickness : float [m]
    diameter : float [m]
        Four times the volume over the surface.
    surface_solidity, mesh_solidity : float [-]
    flow : Flow

    Returns
    -------
    Comparison
        Its nominal solidity is the surface's: nothing overlaps that was ever apart.
    """
    solidity = {"nominal": surface_solidity, "surface": surface_solidity, "mesh": mesh_solidity}
    one = fiber_diameters(np.array([diameter]), np.array([1.0]), flow, mesh_solidity)
    return _compared(solidity, one, thickness, flow)


def _compared(solidity: dict[str, float], diameters: dict[str, float], thickness: float, flow: Flow) -> Comparison:
    mesh_solidity, diameter = solidity["mesh"], diameters["volume"]
    kn = float(slip.knudsen(flow.mean_free_path, diameter))
    re = float(reynolds(flow.density, diameter, flow.face_velocity, flow.viscosity))

    def row(model: PressureModel) -> ModelRow:
        drop = {
            name: float(
                pressure_drop(
                    model.coefficient(share, slip.slip_length(kn)),
                    flow.viscosity,
                    flow.face_velocity,
                    thickness,
                    diameter,
                )
            )
            for name, share in solidity.items()
        }
        return ModelRow(
            **drop,
            overlap=drop["surface"] - drop["nominal"],
            meshing=drop["mesh"] - drop["surface"],
            title=model.title,
            structure=model.structure,
            notes=model.notes(mesh_solidity, kn, re),
        )

    every = {name: row(model) for name, model in MODELS.items()}
    # dense mats lie beyond the pole of some dilute models, which then have no answer
    rows = {name: row for name, row in every.items() if min(_drops(row)) > 0.0 and max(_drops(row)) < math.inf}
    return Comparison(
        solidity=solidity,
        thickness=thickness,
        fiber_diameter=diameter,
        face_velocity=flow.face_velocity,
        models=rows,
        knudsen=kn,
        reynolds=re,
        regime=slip.regime(kn),
        attribution=_attribute(rows, mesh_solidity),
        fiber_diameters=diameters,
    )


def _drops(row: ModelRow) -> tuple[float, float, float]:
    return (row.nominal, row.surface, row.mesh)


def _attribute(rows: dict[str, ModelRow], solidity: float) -> dict[str, float]:
    own = rows[REFERENCE]
    within = [row.mesh for name, row in rows.items() if MODELS[name].low <= solidity <= MODELS[name].high]
    return {
        "overlap": own.surface / own.nominal - 1.0,
        "meshing": own.mesh / own.surface - 1.0,
        "model_low": min([*within, own.mesh]) / own.mesh - 1.0,
        "model_high": max([*within, own.mesh]) / own.mesh - 1.0,
    }
