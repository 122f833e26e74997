"""The page of a measured micrograph: the picture, what was seen drawn over it, and the laws."""

# SPDX-License-Identifier: GPL-3.0-or-later

import base64
import io
import math
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.micrograph.laws import DiameterLaw, Floats
from pipeline.micrograph.measure import Interval, Measured
from pipeline.micrograph.ribbons import Image
from pipeline.microscope.picture import Micrograph
from pipeline.report.page.svg import BLUE, INK, ORANGE, chart
from pipeline.writing import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Bytes = npt.NDArray[np.uint8]

_LONGEST_SIDE = 1600
_PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<title>{title}</title>
<style>
:root {{ color-scheme: light dark }}
body {{ font: 15px/1.5 system-ui, sans-serif; max-width: 1200px; margin: 2em auto; padding: 0 1em }}
figure {{ display: inline-block; width: 48%; min-width: 320px; margin: 0 1% 1em 0; vertical-align: top }}
figure img, figure svg {{ width: 100%; height: auto }}
table {{ border-collapse: collapse }} td, th {{ padding: .15em 1em .15em 0; text-align: left }}
</style>
<h1>{title}</h1>
{warnings}
<table>{rows}</table>
<figure><img alt="the micrograph" src="{picture}"><figcaption>The micrograph, without its strip.</figcaption></figure>
<figure><img alt="what was seen" src="{seen}"><figcaption>What was measured: the middle line of each of {count} fibers,
colored by diameter from thin (blue) to thick (red); lines run on where a fiber is hidden.</figcaption></figure>
{beside}
<figure>{diameters}</figure>
<figure>{directions}</figure>
</html>
"""


def write_page(picture: Micrograph, measured: Measured, path: Path, twin: Micrograph | None = None) -> None:
    """Write the page, one file that asks nothing of the network.

    Parameters
    ----------
    picture : Micrograph
    measured : Measured
    path : Path
        Its folder is made if it is not there.
    twin : Micrograph, optional
        The picture of a mat of the same laws, to stand beside the micrograph.
    """
    title = f"Fibers of a micrograph, {picture.origin}"
    rows = "".join(f"<tr><th>{escape(name)}<td>{escape(value)}" for name, value in facts(picture, measured))
    beside = ""
    if twin is not None:
        beside = (
            f'<figure><img alt="the twin" src="{_png(_bytes(twin.brightness))}">'
            "<figcaption>The picture of its twin: a mat of these laws, at the same scale.</figcaption></figure>"
        )
    page = _PAGE.format(
        title=escape(title),
        warnings="".join(f"<p><strong>Note:</strong> {escape(text)}.</p>" for text in measured.warnings),
        rows=rows,
        picture=_png(_bytes(picture.brightness)),
        seen=_png(_drawn_over(picture, measured)),
        count=measured.fibers,
        beside=beside,
        diameters=_diameter_chart(measured),
        directions=_direction_chart(measured),
    )
    write_whole(path, page)


def facts(picture: Micrograph, measured: Measured) -> list[tuple[str, str]]:
    """Give what was measured in words, for the page and the terminal."""
    law, order = measured.laws[0], measured.orientation
    direction = (
        f"no preferred direction (order {order.order:.2f})"
        if order.law == "isotropic"
        else f"about {order.axis:.0f} degree from x, concentration {order.concentration:.2f} (order {order.order:.2f})"
    )
    width, height = picture.size
    return [
        ("picture", f"{width * 1e6:.4g} x {height * 1e6:.4g} um, {picture.pixel * 1e9:.4g} nm a pixel"),
        ("fibers", str(measured.fibers)),
        ("mean diameter", _um(measured.mean)),
        ("standard deviation", _um(measured.std)),
        ("median diameter", _um(measured.median)),
        ("weighted by length", f"mean {measured.length_mean * 1e6:.4g} um, std {measured.length_std * 1e6:.4g} um"),
        ("best law of diameters", _in_words(law)),
        ("other laws", "; ".join(f"{other.name} (AIC +{other.aic - law.aic:.1f})" for other in measured.laws[1:])),
        ("directions", direction),
        ("covered by these fibers", f"{100 * measured.coverage:.0f} %"),
        ("ends within the picture", f"{100 * measured.ends:.0f} %"),
        ("blur of the picture", f"{measured.blur:.2f} pixels"),
    ]


def _um(interval: Interval) -> str:
    return f"{interval.value * 1e6:.4g} um ({interval.low * 1e6:.4g} to {interval.high * 1e6:.4g})"


def _in_words(law: DiameterLaw) -> str:
    values = (
        f"{name} {value:.3g}" if name == "share" or name.startswith("geometric") else f"{name} {value * 1e6:.4g} um"
        for name, value in law.parameters.items()
    )
    return f"{law.name}: {', '.join(values)}"


def _bytes(brightness: Image) -> Bytes:
    return np.round(255 * brightness).astype(np.uint8)


def _png(pixels: Bytes) -> str:
    from PIL import Image as Pillow

    image = Pillow.fromarray(pixels)
    image.thumbnail((_LONGEST_SIDE, _LONGEST_SIDE))
    buffer = io.BytesIO()
    image.save(buffer, format="png", optimize=True)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")


def _drawn_over(picture: Micrograph, measured: Measured) -> Bytes:
    from PIL import Image as Pillow
    from PIL import ImageDraw

    image = Pillow.fromarray(_bytes(picture.brightness)).convert("RGB")
    pen = ImageDraw.Draw(image)
    rank = measured.diameter.argsort().argsort() / max(measured.fibers - 1, 1)
    for line, owner in zip(measured.lines, measured.owner, strict=True):
        share = float(rank[owner])
        color = (round(255 * share), round(140 * (1 - abs(2 * share - 1))) + 60, round(255 * (1 - share)))
        pen.line([tuple(point) for point in line.tolist()], fill=color, width=2)
    return np.asarray(image)


def _diameter_chart(measured: Measured) -> str:
    micro = 1e6 * measured.diameter

    def draw(axes: "Axes") -> None:
        _, edges, _ = axes.hist(micro, bins=min(30, 6 + measured.fibers // 8), color=BLUE)
        at = np.linspace(max(edges[0] * 0.8, 1e-3), edges[-1] * 1.1, 300)
        for law, color in zip(measured.laws, (INK, ORANGE), strict=False):
            height = density(law, 1e-6 * at) * 1e-6 * measured.fibers * (edges[1] - edges[0])
            axes.plot(at, height, color=color, linewidth=1.2, label=law.name)
        axes.set(xlabel="fiber diameter [µm]", ylabel="fibers", title="Diameters")
        axes.legend(frameon=False)

    return str(chart("diameters", draw))


def density(law: DiameterLaw, diameter: Floats) -> Floats:
    """Give a law's density [1/m] at diameters [m]."""
    p = law.parameters

    def normal(value: Floats, mean: float, std: float) -> Floats:
        height: Floats = np.exp(-0.5 * ((value - mean) / std) ** 2) / (std * math.sqrt(2 * math.pi))
        return height

    if law.name == "normal":
        return normal(diameter, p["mean"], p["std"])
    log = np.log(diameter)
    kinds = (
        [(1.0, p["median"], p["geometric_std"])]
        if law.name == "lognormal"
        else [
            (p["share"], p["median_1"], p["geometric_std_1"]),
            (1.0 - p["share"], p["median_2"], p["geometric_std_2"]),
        ]
    )
    height = [share * normal(log, math.log(median), math.log(width)) for share, median, width in kinds]
    return np.asarray(np.sum(height, axis=0) / diameter)


def _direction_chart(measured: Measured) -> str:
    share, edges = np.histogram(np.degrees(measured.angle), bins=12, range=(0, 180), weights=measured.length)
    share = 100 * share / share.sum()

    def draw(axes: "Axes") -> None:
        axes.bar(edges[:-1], share, width=np.diff(edges), align="edge", color=BLUE)
        axes.axhline(100 / 12, color=INK, linewidth=1, linestyle="--", label="no preferred direction")
        axes.set(
            xlabel="direction [degree from x]",
            ylabel="share of length [%]",
            xticks=range(0, 181, 30),
            title="Directions",
        )
        axes.legend(frameon=False)

    return str(chart("directions", draw))
