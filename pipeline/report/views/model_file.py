"""The geometry, the mesh and the flow to turn in a browser, in one file that asks nothing of the network."""

# SPDX-License-Identifier: GPL-3.0-or-later

import base64
import hashlib
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from markupsafe import Markup

from pipeline.geometry.box import Box
from pipeline.report.page.html import templates, typeset
from pipeline.report.page.quality_section import LengthUnit, unit_for
from pipeline.report.views.drawing import CELLS, EDGES, PALETTE
from pipeline.report.views.layers import Layer, Model
from pipeline.report.views.model_cells import NODES, Field, ModelCells
from pipeline.report.views.model_flow import NumberField, Particles, Streamlines
from pipeline.writing import write_whole

_STEPS = 65_535
"""Coordinates are whole numbers up to this, of the largest extent: a micrometer in 30 micrometers is 2,000 of them."""
_FLOW_TO_THE_RIGHT = {"towards": (1.0, -0.42, 0.5), "up": (0.0, 1.0, 0.0)}
_Z_UPWARD = {"towards": (0.75, 1.15, -0.85), "up": (0.0, 0.0, 1.0)}
_SCRIPTS = ("shaders.js", "buffers.js", "section.js", "model.js")
_RAMP, _SPEED_RAMP, _SHADES = "viridis", "plasma", 16
_FEW = 60_000
"""Up to this many triangles their edges are drawn at first; more would blacken the picture."""


def write_model(model: Model, title: str, path: Path, flow: bool = True) -> None:
    """Write the model.

    Parameters
    ----------
    model : Model
    title : str
    path : Path
        The file; its folder is made if it is not there.
    flow : bool
        Whether the air is to flow to the right at first; z points upward otherwise.
    """
    page = model_html(model, title, flow)
    write_whole(path, page)


def model_html(model: Model, title: str, flow: bool = True) -> str:
    """Give the page as text; title and names are escaped, and no script may run but the one whose hash is named."""
    folder = files("pipeline.report.page").joinpath("templates")
    script = '"use strict";\n' + "".join(folder.joinpath(name).read_text(encoding="utf-8") for name in _SCRIPTS)
    hashed = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    low, high = _bounds(model)
    unit = unit_for(float((high - low).max()))
    extents = " × ".join(f"{extent:.4g}" for extent in ((high - low) * unit.per_meter).tolist())
    return (
        templates()
        .get_template("model.html.jinja")
        .render(
            title=title,
            permission=f"sha256-{hashed}",
            script=Markup(script),
            model=_content(model, unit, flow),
            size=f"{extents} {unit.name}",
            unit=unit.name,
            numbered=f"{label}s" if (label := _label(model)) else "",
            note=typeset(model.note),
        )
    )


def _bounds(model: Model) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    corners = [np.array(corner) for box in model.outlines.values() for corner in (box.lower, box.upper)]
    clouds = [layer.points for layer in model.layers] + [each.places for each in model.particles]
    if model.cells is not None:
        clouds.append(model.cells.points)
    if model.streamlines is not None:
        clouds.append(model.streamlines.points)
    points = np.concatenate([*clouds, corners])
    return points.min(axis=0), points.max(axis=0)


def _label(model: Model) -> str:
    return next((layer.label for layer in model.layers if layer.label), "")


def _content(model: Model, unit: LengthUnit, flow: bool) -> dict[str, Any]:
    low, high = _bounds(model)
    step = float((high - low).max()) / _STEPS
    lines = sum(len(layer.triangles) for layer in model.layers) <= _FEW
    return {
        "layers": [_layer(layer, low, step) for layer in model.layers],
        "outlines": [_outline(name, box, low, step) for name, box in model.outlines.items()],
        "origin": low.tolist(),
        "step": step,
        "low": [0.0, 0.0, 0.0],
        "high": ((high - low) / step).tolist(),
        "middle": (0.5 * (high - low) / step).tolist(),
        # the sphere around everything fills the window's height
        "reach": 0.5 * float(np.linalg.norm(high - low)) / step,
        "unit": unit.name,
        "perMeter": unit.per_meter,
        "palette": ["#" + bytes(color).hex() for color in PALETTE.tolist()],
        "ink": EDGES,
        "lines": lines,
        "cells": None if model.cells is None else _cells(model.cells, low, step),
        "cellColor": CELLS,
        "axis": model.axis,
        "streamlines": None if model.streamlines is None else _streamlines(model.streamlines, low, step),
        "particles": [_particles(each, low, step) for each in model.particles],
        "numbered": f"{_label(model)} number",
        "numberFields": [_number_field(each) for each in model.number_fields],
        **(_FLOW_TO_THE_RIGHT if flow else _Z_UPWARD),
    }


def _layer(layer: Layer, low: npt.NDArray[np.float64], step: float) -> dict[str, Any]:
    return {
        "name": layer.name,
        "color": layer.color,
        "opacity": layer.opacity,
        "shown": layer.shown,
        "label": layer.label,
        "solid": layer.solid,
        "points": _places(layer.points, low, step),
        "triangles": _text(layer.triangles, "<u4"),
        "edges": _text(layer.edges, "u1"),
        "numbers": _text(layer.number, "<u4"),
    }


def _cells(cells: ModelCells, low: npt.NDArray[np.float64], step: float) -> dict[str, Any]:
    simple = bool((cells.sides == cells.sides[0]).all() and cells.sides[0] == 0b1111)
    plain = bool((cells.cell == np.arange(len(cells.cell))).all())
    return {
        "points": _places(cells.points, low, step),
        "tets": _text(cells.tets, "<u4"),
        "sides": None if simple else _text(cells.sides, "u1"),
        "cell": None if plain else _text(cells.cell, "<u4"),
        "fields": [_field(each) for each in cells.fields],
        "first": 0 if cells.fields and cells.fields[0].at == NODES else -1,
    }


def _field(field: Field) -> dict[str, Any]:
    return {
        "name": field.name,
        "unit": field.unit,
        "at": field.at,
        "low": field.low,
        "high": field.high,
        "values": _shares(field.values, field.low, field.high),
        "colors": _ramp(_SPEED_RAMP if field.at == NODES else _RAMP),
    }


def _streamlines(lines: Streamlines, low: npt.NDArray[np.float64], step: float) -> dict[str, Any]:
    return {
        "name": f"{len(lines.starts) - 1:,} streamlines",
        "shown": False,
        "points": _places(lines.points, low, step),
        "starts": _text(lines.starts, "<u4"),
        "values": _shares(lines.speed, 0.0, lines.fastest),
        "low": 0.0,
        "high": lines.fastest,
        "unit": "cm/s",
        "colors": _ramp(_SPEED_RAMP),
    }


def _particles(particles: Particles, low: npt.NDArray[np.float64], step: float) -> dict[str, Any]:
    return {
        "name": particles.name,
        "shown": False,
        "points": _places(particles.places, low, step),
        "radius": particles.radius / step,
        "color": particles.color,
    }


def _number_field(field: NumberField) -> dict[str, Any]:
    low, high = min(field.values), max(field.values)
    return {
        "name": field.name,
        "unit": field.unit,
        "low": low,
        "high": high,
        "values": list(field.values),
        "colors": _ramp(_RAMP),
    }


def _ramp(name: str) -> list[str]:
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return [to_hex(color) for color in colormaps[name](np.linspace(0.0, 1.0, _SHADES))]


def _shares(values: npt.NDArray[np.float64], low: float, high: float) -> str:
    shares = np.nan_to_num((values - low) / (high - low if high > low else 1.0), nan=0.0, posinf=1.0, neginf=0.0)
    return _text(np.rint(_STEPS * shares.clip(0.0, 1.0)), "<u2")


def _places(points: npt.NDArray[np.float64], low: npt.NDArray[np.float64], step: float) -> str:
    return _text(np.rint((points - low) / step).clip(0, _STEPS), "<u2")


def _outline(name: str, box: Box, low: npt.NDArray[np.float64], step: float) -> dict[str, Any]:
    lower, upper = (((np.array(corner) - low) / step).tolist() for corner in (box.lower, box.upper))
    return {"name": name, "low": lower, "high": upper}


def _text(values: npt.NDArray[Any], kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values.astype(kind)).tobytes()).decode("ascii")
