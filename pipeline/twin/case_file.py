"""A twin as a case file."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

from pipeline.analytics.settings import FlowSettings
from pipeline.design.packing import Place
from pipeline.mat.case_lines import table_lines
from pipeline.micrograph.case import picture_lines
from pipeline.twin.fibers import Diameters, FiberLaws, scaled
from pipeline.units import written


@dataclass(frozen=True, slots=True)
class Choice:
    """What a search is free to choose of a mat.

    Parameters
    ----------
    scale : float [-]
        Of the fibers' diameters.
    place : tuple of float
        Relaxation slope [-] and spacing [m].
    coverage : float [-]
        The stop.
    seed : int
    """

    scale: float
    place: Place
    coverage: float
    seed: int


def case_text(
    fibers: FiberLaws,
    side: float,
    contact: str,
    flow: FlowSettings,
    choice: Choice,
    solved: bool,
    head: str,
    picture: str | None = None,
) -> str:
    """Write the case file (TOML) of a mat.

    Parameters
    ----------
    fibers : FiberLaws
    side : float [m]
    contact : str
    flow : FlowSettings
    choice : Choice
    solved : bool
        Whether the flow is solved.
    head : str
        Comment at the top, line by line without their signs.
    picture : str, optional
        Path of the micrograph from the case file's folder.
    """
    slope, spacing = choice.place
    law: Diameters = scaled(fibers.diameters, choice.scale)
    lines = [
        *(f"# {line}" for line in head.splitlines()),
        "",
        "[mat]",
        'generator = "layered"',
        f'side = "{written(side, "m")}"',
        f"relaxation_slope = {slope:.4g}",
        f'contact = "{contact}"',
        f'spacing = "{written(spacing, "m")}"',
        f"seed = {choice.seed}",
        "",
        "[mat.fiber_diameter]",
        *table_lines(law),
        "",
        "[mat.orientation]",
        *table_lines(fibers.directions),
        "",
        "[mat.stop]",
        f"coverage = {choice.coverage!r}",
        "",
        "[flow]",
        f'face_velocity = "{written(flow.face_velocity, "m/s")}"',
        f'temperature = "{written(flow.temperature, "kelvin")}"',
        f'pressure = "{written(flow.pressure, "Pa")}"',
        f'pressure_model = "{flow.pressure_model}"',
    ]
    if picture is not None and fibers.pixel is not None:
        lines += picture_lines(picture, fibers.pixel)
    if solved:
        lines += ["", "[solve]   # the flow, to hold beside what was measured", 'engine = "stokes"']
    return "\n".join(lines) + "\n"
