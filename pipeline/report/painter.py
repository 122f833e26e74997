"""The child process that draws: `python -m pipeline.report.painter FOLDER`; VTK renders nowhere else for a report."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline import store
from pipeline.data import FaceMesh, FluidDomain, Mat, Surface
from pipeline.report.scenes import BACKGROUND, SCENES, Subject

if TYPE_CHECKING:
    from PIL import Image

NOUNS = {"mat": Mat, "surface": Surface, "domain": FluidDomain, "mesh": FaceMesh}
"""Parts of a subject that are handed over as files."""
WORST, ORDER = "worst.npy", "order.json"
_FRAME = 16  # pixels of background kept around a picture
_QUALITY = 82  # of JPEG: no rim shows around lines, and a page of eight pictures stays near 1 MB


def main(folder: Path) -> None:
    """Draw what the order asks for, one file per scene."""
    import pyvista as pv
    from PIL import Image

    order = json.loads((folder / ORDER).read_text())
    subject = read_subject(folder)
    for name in order["scenes"]:
        scene = SCENES[name]
        plotter = pv.Plotter(off_screen=True, window_size=scene.size)
        plotter.set_background(BACKGROUND)
        plotter.enable_anti_aliasing("ssaa")
        scene.draw(plotter, subject)
        picture = trimmed(Image.fromarray(plotter.screenshot(None, return_img=True)))
        plotter.close()
        if order["kind"] == "png":
            picture.save(folder / f"{name}.png", optimize=True)
        else:
            picture.save(folder / f"{name}.jpg", quality=_QUALITY, optimize=True)


def trimmed(picture: "Image.Image") -> "Image.Image":
    """Cut off the margin of plain background, but for a small frame."""
    from PIL import Image, ImageChops

    plain = Image.new("RGB", picture.size, BACKGROUND)
    found = ImageChops.difference(picture.convert("RGB"), plain).getbbox()
    if found is None:
        return picture
    left, top, right, bottom = found
    return picture.crop(
        (max(left - _FRAME, 0), max(top - _FRAME, 0), min(right + _FRAME, picture.width),
         min(bottom + _FRAME, picture.height))
    )  # fmt: skip


def read_subject(folder: Path) -> Subject:
    """Read what `pipeline.report.render.Painting` handed over."""
    nouns: dict[str, Any] = {
        name: store.load(kind, folder / f"{name}.npz")
        for name, kind in NOUNS.items()
        if (folder / f"{name}.npz").exists()
    }
    worst = np.load(folder / WORST, allow_pickle=False) if (folder / WORST).exists() else None
    return Subject(**nouns, worst=worst)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
