"""Micrographs as PNG files that say their own scale."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.microscope.picture import Micrograph
from pipeline.writing import whole_file


def write_png(picture: Micrograph, path: Path) -> None:
    """Write a picture with 8 bits, and the length of its pixel where `read_micrograph` finds it.

    Parameters
    ----------
    picture : Micrograph
    path : Path
    """
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    notes = PngInfo()
    notes.add_text("Description", picture.origin)
    per_inch = 0.0254 / picture.pixel
    image = Image.fromarray((255 * picture.brightness).round().astype("uint8"))
    with whole_file(path) as side:
        image.save(side, format="png", pnginfo=notes, dpi=(per_inch, per_inch))
