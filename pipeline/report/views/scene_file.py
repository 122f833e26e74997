"""scene.html: the geometry and the mesh to turn in a browser, in one file that asks nothing of the network."""

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
from pipeline.report.views.drawing import EDGES, PALETTE
from pipeline.report.views.layers import Layer, Model

_STEPS = 65_535
"""Coordinates are whole numbers up to this, of the largest extent: a micrometer in 30 micrometers is 2,000 of them."""
_FLOW_TO_THE_RIGHT = {"towards": (1.0, -0.42, 0.5), "up": (0.0, 1.0, 0.0)}
_Z_UPWARD = {"towards": (0.75, 1.15, -0.85), "up": (0.0, 0.0, 1.0)}
_FEW = 60_000
"""Up to this many triangles their edges are drawn at first; more would blacken the picture."""


def write_scene(model: Model, title: str, path: Path, flow: bool = True) -> None:
    """Write the scene.

    Parameters
    ----------
    model : Model
    title : str
    path : Path
        The file; its folder is made if it is not there.
    flow : bool
        Whether the air is to flow to the right at first; z points upward otherwise.
    """
    page = scene_of(model, title, flow)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page, encoding="utf-8")


def scene_of(model: Model, title: str, flow: bool = True) -> str:
    """Give the scene as text; title and names are escaped, and no script may run but the one whose hash is named."""
    script = files("pipeline.report.page").joinpath("templates/scene.js").read_text(encoding="utf-8")
    hashed = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    low, high = _bounds(model)
    unit = unit_for(float((high - low).max()))
    extents = " × ".join(f"{extent:.4g}" for extent in ((high - low) * unit.per_meter).tolist())
    return (
        templates()
        .get_template("scene.html.jinja")
        .render(
            title=title,
            permission=f"sha256-{hashed}",
            script=Markup(script),
            model=_content(model, unit, flow),
            size=f"{extents} {unit.name}",
            note=typeset(model.note),
        )
    )


def _bounds(model: Model) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    corners = [np.array(corner) for box in model.outlines.values() for corner in (box.lower, box.upper)]
    points = np.concatenate([*(layer.points for layer in model.layers), corners])
    return points.min(axis=0), points.max(axis=0)


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
        **(_FLOW_TO_THE_RIGHT if flow else _Z_UPWARD),
    }


def _layer(layer: Layer, low: npt.NDArray[np.float64], step: float) -> dict[str, Any]:
    return {
        "name": layer.name,
        "color": layer.color,
        "opacity": layer.opacity,
        "shown": layer.shown,
        "label": layer.label,
        "points": _text(np.rint((layer.points - low) / step), "<u2"),
        "triangles": _text(layer.triangles, "<u4"),
        "edges": _text(layer.edges, "u1"),
        "numbers": _text(layer.number, "<u4"),
    }


def _outline(name: str, box: Box, low: npt.NDArray[np.float64], step: float) -> dict[str, Any]:
    lower, upper = (((np.array(corner) - low) / step).tolist() for corner in (box.lower, box.upper))
    return {"name": name, "low": lower, "high": upper}


def _text(values: npt.NDArray[Any], kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values.astype(kind)).tobytes()).decode("ascii")
