"""The paper's analytical figures drawn again: ``python -m validation.paper_figures docs/gallery``."""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from pathlib import Path

from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.analytics.tables.plots import draw_efficiency, draw_figure_of_merit, draw_pressure_drop, save_figure

FIGURE_10 = FilterSettings(solidity=0.0948, thickness=47.0e-6, fiber_diameter=1.4e-6)
"""Section 5.1, at 2.5 cm/s."""

FIGURE_11 = FilterSettings(solidity=0.1117, thickness=68.5e-6, fiber_diameter=0.5e-6)
"""Section 5.2, at 2.5 cm/s."""

FIGURE_12 = FilterSettings(solidity=0.1198, thickness=42.3e-6, fiber_diameter=0.5e-6)
"""Section 5.3, at 2.5 cm/s."""

TABLE_A6 = FilterSettings(solidity=0.05, thickness=1.0e-3, fiber_diameter=2.0e-6)
"""Table A6, at 10 cm/s; it leaves solidity and thickness unprinted."""

SLOW = FlowSettings(face_velocity=0.025)
FAST = FlowSettings(face_velocity=0.1, preset="table_a6")

_DRAWINGS = {
    "figure_1.svg": (draw_pressure_drop, FIGURE_10, SLOW),
    "figure_10d.svg": (draw_efficiency, FIGURE_10, SLOW),
    "figure_10e.svg": (draw_figure_of_merit, FIGURE_10, SLOW),
    "figure_12b.svg": (draw_efficiency, FIGURE_12, SLOW),
    "figure_a8.svg": (draw_efficiency, TABLE_A6, FAST),
}


def write_paper_figures(folder: Path) -> list[Path]:
    """Draw Figs. 1, 10d, 10e, 12b and A8 into a folder that exists.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    list of Path
        The files written.
    """
    from matplotlib.figure import Figure

    written = []
    for name, (draw, medium, settings) in _DRAWINGS.items():
        figure = Figure(figsize=(6.0, 5.2), layout="constrained")
        draw(figure.subplots(), medium, settings)
        save_figure(figure, folder / name)
        written.append(folder / name)
    return written


if __name__ == "__main__":
    write_paper_figures(Path(sys.argv[1]))
