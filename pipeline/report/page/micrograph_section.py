"""The section of the micrographs: the mat's beside the real medium's."""

# SPDX-License-Identifier: GPL-3.0-or-later

import base64
import io
from pathlib import Path

from pipeline.analytics.tables.rows import length
from pipeline.line.results import Results
from pipeline.line.store import DAMAGE
from pipeline.nouns.micrographs import Micrographs
from pipeline.nouns.section import Facts, Photograph, Photographs, Section, Text
from pipeline.reading import read_bytes

_LARGEST_FILE = 200_000_000
_LONGEST_SIDE = 900
"""Pixels of a picture on the page: what a column shows on a fine screen."""


def micrograph(content: Results) -> Section | None:
    """Show the picture of the mat, and beside it that of the real medium where the case has one."""
    pictures = content.get(Micrographs)
    if pictures is None:
        return None
    folder = content.path(Micrographs).parent
    photographs = [
        Photograph(_jpeg(folder / pictures.twin), "The twin: this mat from above, as a microscope shows it.")
    ]
    if pictures.measured is not None:
        name = content.case.micrograph.file
        caption = f"The real medium, {Path(name).name if name is not None else 'measured'}, at the same scale."
        photographs.append(Photograph(_jpeg(folder / pictures.measured), caption))
    seen = f"{length(pictures.width)} x {length(pictures.height)}, {pictures.pixel * 1e9:.4g} nm a pixel"
    words = Text("Both are cut to the same size. Brightness falls with depth; rims of fibers are brighter.", "soft")
    parts = (Photographs(tuple(photographs)), Facts((("seen", seen),)))
    return Section(
        "micrograph", "Micrograph", "The twin under the microscope", (*parts, words) if pictures.measured else parts
    )


def _jpeg(path: Path) -> str:
    """Give a picture as the address of its own content."""
    from PIL import Image

    try:
        with Image.open(io.BytesIO(read_bytes(path, _LARGEST_FILE)), formats=("png",)) as image:
            image.thumbnail((_LONGEST_SIDE, _LONGEST_SIDE))
            buffer = io.BytesIO()
            image.convert("L").save(buffer, format="jpeg", quality=85)
    except DAMAGE:
        # a run's folder may be damaged, and the rest of its page is not
        return ""
    return "data:image/jpeg;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
