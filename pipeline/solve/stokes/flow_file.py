"""The flow as a file that ParaView opens."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np

from pipeline.nouns.arrays import Floats
from pipeline.nouns.flow_field import EDGES, FlowField
from pipeline.solve.stokes.elements import shape

_QUADRATIC_TETRAHEDRON = 24  # VTK's number of the cell
_AT_ONCE = 20_000  # cells whose gradients are held at a time


def write_flow(field: FlowField, viscosity: float, path: Path) -> None:
    """Write velocity [m/s], pressure [Pa] and shear stress [Pa] at the nodes of curved tetrahedra as ``.vtu``.

    Parameters
    ----------
    field : FlowField
    viscosity : float [Pa s]
    path : Path
    """
    import pyvista

    cells = np.column_stack([np.full(len(field.cells), 10), field.cells]).ravel()
    grid = pyvista.UnstructuredGrid(cells, np.full(len(field.cells), _QUADRATIC_TETRAHEDRON), field.positions)
    grid.point_data["velocity"] = field.velocity.astype(np.float32)
    grid.point_data["pressure"] = pressure_at_nodes(field).astype(np.float32)
    grid.point_data["shear"] = (viscosity * shear_rate(field)).astype(np.float32)
    grid.save(path)


def pressure_at_nodes(field: FlowField) -> Floats:
    """Pressure at vertices and at the middles of edges, (n,) array [Pa]."""
    total, count = np.zeros(len(field.positions)), np.zeros(len(field.positions))
    ends = field.pressure[field.cells[:, :4]]
    np.add.at(total, field.cells, np.hstack([ends, ends[:, EDGES].mean(axis=2)]))
    np.add.at(count, field.cells, 1.0)
    return total / np.maximum(count, 1.0)


def shear_rate(field: FlowField) -> Floats:
    r"""Shear rate :math:`\sqrt{2 e : e}` at the nodes, (n,) array [1/s], averaged over the cells that meet there."""
    slopes = shape(np.concatenate([np.eye(4), 0.5 * (np.eye(4)[EDGES[:, 0]] + np.eye(4)[EDGES[:, 1]])]))[1]
    total, count = np.zeros(len(field.positions)), np.zeros(len(field.positions))
    for first in range(0, len(field.cells), _AT_ONCE):
        cells = field.cells[first : first + _AT_ONCE]
        jacobian = np.einsum("cka,qkb->cqab", field.positions[cells], slopes)
        by_place = np.einsum("cka,qkb->cqab", field.velocity[cells], slopes)
        gradient = by_place @ np.linalg.inv(jacobian)
        strain = 0.5 * (gradient + gradient.swapaxes(2, 3))
        np.add.at(total, cells, np.sqrt(2.0 * np.einsum("cqab,cqab->cq", strain, strain)))
        np.add.at(count, cells, 1.0)
    return total / np.maximum(count, 1.0)
