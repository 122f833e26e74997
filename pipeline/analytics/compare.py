"""Pressure drop by every model from the nominal, the surface's and the mesh's solidity, side by side."""

import math

from pipeline.analytics import slip
from pipeline.analytics.cell import reynolds
from pipeline.analytics.pressure_drop import pressure_drop
from pipeline.analytics.pressure_models import MODELS, PressureModel
from pipeline.data import Comparison, Flow, Mat, ModelRow


def nominal_solidity(mat: Mat) -> float:
    """Volume of all the fibers' cylinders over the slab's volume, overlaps counted twice [-]."""
    section = math.pi * mat.radius[mat.segment_fibers()] ** 2
    return float((section * mat.segment_lengths()).sum()) / mat.slab.volume


def drag_diameter(mat: Mat) -> float:
    """Diameter whose square is the mean over fiber length [m].

    Fibers of different diameters with the same total length and volume resist alike in every model without slip,
    because the drag per length depends on the solidity alone.
    """
    lengths = mat.segment_lengths()
    squares = (2.0 * mat.radius[mat.segment_fibers()]) ** 2
    return math.sqrt(float((squares * lengths).sum() / lengths.sum()))


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
    """
    diameter = drag_diameter(mat)
    solidity = {"nominal": nominal_solidity(mat), "surface": surface_solidity, "mesh": mesh_solidity}
    kn = float(slip.knudsen(flow.mean_free_path, diameter))
    re = float(reynolds(flow.density, diameter, flow.face_velocity, flow.viscosity))

    def row(model: PressureModel) -> ModelRow:
        drops = {
            name: float(
                pressure_drop(
                    model.coefficient(share, slip.slip_length(kn)),
                    flow.viscosity,
                    flow.face_velocity,
                    mat.thickness,
                    diameter,
                )
            )
            for name, share in solidity.items()
        }
        return ModelRow(**drops, notes=model.notes(mesh_solidity, kn, re))

    return Comparison(
        solidity=solidity,
        thickness=mat.thickness,
        fiber_diameter=diameter,
        face_velocity=flow.face_velocity,
        models={name: row(model) for name, model in MODELS.items()},
    )
