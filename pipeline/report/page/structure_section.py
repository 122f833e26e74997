"""The section of the air between the fibers: the sizes of its pores, and the way through."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from pipeline.line.results import Results
from pipeline.nouns.permeability import permeability_table, read_permeability
from pipeline.nouns.section import Charts, Columns, Facts, Part, Section, Text
from pipeline.nouns.structure import Structure
from pipeline.report.page.svg import BLUE, GREEN, ORANGE, chart
from pipeline.structure.tables import structure_rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def structure(content: Results) -> Section | None:
    """Show the sizes of pores and what they let through."""
    found, permeability = content.get(Structure), read_permeability(content.folder)
    if found is None and permeability is None:
        return None
    parts: list[Part] = [] if found is None else [_pores(found)]
    if permeability is not None:
        words = (
            "Darcy's permeability; in its plane the mat was turned and solved as a case of its own, with air before "
            "and behind it. Beyond its sides a medium goes on as its mirror image, so the tensor is diagonal."
        )
        parts += [permeability_table(permeability), Text(words, "soft")]
    return Section("structure", "Pores", "The air between the fibers", tuple(parts))


def _pores(found: Structure) -> Columns:
    drawing = Charts(
        (pore_chart(found),),
        "Volume of air by the largest sphere that fits in and holds it. Bubble point: the largest sphere that passes "
        "through. Mean flow pore: spheres of this size enter what carries half of the dry flow, of air that flows "
        "as through tubes.",
    )
    measured = (
        f"Measured on {' x '.join(map(str, found.voxels))} voxels of {1e9 * found.voxel:.3g} nm; beyond the sides the "
        "medium goes on. Tortuosity: porosity over the relative diffusivity of a gas that the fibers do not take up."
    )
    facts = (Facts(structure_rows(found)), Text(measured, "soft"))
    return Columns((facts, (drawing,)))


def pore_chart(found: Structure) -> Markup:
    """Draw the share of air in each size of pores, and the sizes that let air through."""
    edges, share = 1e6 * np.array(found.pores.diameter), np.array(found.pores.share)

    def draw(axes: "Axes") -> None:
        axes.stairs(-100 * np.diff(share), edges, fill=True, color=BLUE, alpha=0.6)
        for size, color, name in (
            (found.bubble_point, ORANGE, "bubble point"),
            (found.mean_flow_pore, GREEN, "mean flow pore"),
        ):
            if size > 0.0:
                axes.axvline(1e6 * size, color=color, linewidth=1.5, label=f"{name} {1e6 * size:.3g} µm")
        axes.set(xlabel="pore diameter [µm]", ylabel="share of the air's volume [%]", title="Pores", xlim=(0, None))
        axes.legend(frameon=False)

    return chart("pores", draw)
