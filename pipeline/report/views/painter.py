"""The child process that draws a page's pictures: `python -m pipeline.report.views.painter DIR`."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.line import store
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.surface import Surface
from pipeline.report.views.drawing import BACKGROUND, Scene
from pipeline.report.views.mesh_scenes import MESH_SCENES, MeshSubject
from pipeline.report.views.scenes import SCENES, Subject

if TYPE_CHECKING:
    from PIL import Image

_NOUNS = {"mat": Mat, "surface": Surface, "domain": FluidDomain, "mesh": FaceMesh, "flow": FlowField}
ORDER = "order.json"
_KINDS: dict[str, type[Subject] | type[MeshSubject]] = {kind.__name__: kind for kind in (Subject, MeshSubject)}
_FRAME = 16  # pixels of background kept around a picture
_QUALITY = 82  # of JPEG: no rim shows around lines, and a page of eight pictures stays near 1 MB


def main(folder: Path) -> None:
    """Draw what the order asks for, one file per scene."""
    import pyvista as pv
    from PIL import Image

    order = json.loads((folder / ORDER).read_text())
    subject = read_subject(folder, order["kind of subject"])
    for name in order["scenes"]:
        scene = scenes_of(subject)[name]
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


def scenes_of(subject: Subject | MeshSubject) -> dict[str, Scene]:
    """Give the views that there are of subjects of this kind, by their names."""
    return MESH_SCENES if isinstance(subject, MeshSubject) else SCENES


def possible(subject: Subject | MeshSubject) -> tuple[str, ...]:
    """Names of the scenes for which everything is there."""
    found = scenes_of(subject).items()
    return tuple(name for name, scene in found if all(getattr(subject, need) is not None for need in scene.needs))


def write_subject(subject: Subject | MeshSubject, folder: Path) -> str:
    """Hand a subject over as files; gives the name of its kind, for the order."""
    for item in dataclasses.fields(subject):
        part = getattr(subject, item.name)
        if isinstance(part, np.ndarray):
            np.save(folder / f"{item.name}.npy", part, allow_pickle=False)
        elif part is not None:
            store.save(part, folder / f"{item.name}.npz")
    return type(subject).__name__


def read_subject(folder: Path, kind: str) -> Subject | MeshSubject:
    """Read what `write_subject` wrote."""
    parts: dict[str, Any] = {}
    for item in dataclasses.fields(_KINDS[kind]):
        if (folder / f"{item.name}.npz").exists():
            parts[item.name] = store.load(_NOUNS[item.name], folder / f"{item.name}.npz")
        elif (folder / f"{item.name}.npy").exists():
            parts[item.name] = np.load(folder / f"{item.name}.npy", allow_pickle=False)
    return _KINDS[kind](**parts)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
