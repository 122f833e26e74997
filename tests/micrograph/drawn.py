"""Pictures of bands whose width is known, drawn without the code under test."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter

Picture = npt.NDArray[np.float64]


def bands(
    widths: npt.NDArray[np.float64],
    shape: tuple[int, int] = (600, 700),
    seed: int = 0,
    blur: float = 1.0,
    noise: float = 0.03,
    angles: npt.NDArray[np.float64] | None = None,
    shade: str = "flat",
) -> Picture:
    """Draw straight bands across a picture, the later ones over the earlier; brightness from 0 to 1.

    A band's pixel is covered by how far it lies within the band, so widths need not be whole numbers.
    """
    random = np.random.default_rng(seed)
    rows, columns = shape
    y, x = np.mgrid[:rows, :columns].astype(np.float64)
    picture = np.full(shape, 0.12)
    for k, width in enumerate(widths):
        angle = random.uniform(0, np.pi) if angles is None else angles[k]
        px, py = random.uniform(0, columns), random.uniform(0, rows)
        away = -(x - px) * np.sin(angle) - (y - py) * np.cos(angle)
        cover = np.clip(0.5 * width + 0.5 - np.abs(away), 0, 1)
        level = 0.45 + 0.4 * k / len(widths)
        if shade == "round":
            level = level * (0.6 + 0.4 * np.sqrt(np.clip(1 - (2 * away / width) ** 2, 0, 1)))
        picture = picture * (1 - cover) + level * cover
    picture = gaussian_filter(picture, blur)
    return np.clip(picture + noise * random.standard_normal(shape), 0, 1)


def as_bytes(picture: Picture) -> npt.NDArray[np.uint8]:
    """Give the picture in 8 bits."""
    return np.round(255 * picture).astype(np.uint8)
