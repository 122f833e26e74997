"""Which voxels are solid: a threshold, and islands and pores of less than a stated size left out."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.errors import CaseError
from pipeline.tomography.read import Gray

Solid = npt.NDArray[np.bool_]
_FEWEST, _MOST = 0.001, 0.9


@dataclass(frozen=True, eq=False, slots=True)
class Segmented:
    """Solid voxels, and how they were told from air.

    Parameters
    ----------
    solid : (x, y, z) bool array
    threshold : float
        Gray value from which on a voxel is solid.
    islands, pores : int
        Voxels of islands that were left out, and of pores that were closed.
    """

    solid: Solid
    threshold: float
    islands: int
    pores: int

    @property
    def solidity(self) -> float:
        """Share of solid voxels [-]."""
        return float(self.solid.mean())


def segment(gray: Gray, threshold: float | None = None, smallest: int = 0, dark: bool = False) -> Segmented:
    """Tell the solid from the air.

    Parameters
    ----------
    gray : (x, y, z) array
    threshold : float, optional
        Gray value between air and solid; by Otsu's method unless given.
    smallest : int
        Islands of solid and closed pores of fewer voxels are noise.
    dark : bool
        Whether the solid is darker than the air.

    Returns
    -------
    Segmented

    Raises
    ------
    CaseError
        If next to nothing or nearly everything is solid.
    """
    from skimage.filters import threshold_otsu
    from skimage.measure import label

    if not np.isfinite([gray.min(), gray.max()]).all() or gray.min() == gray.max():
        raise CaseError(f"the tomogram shows nothing: all of its {gray.size:,} voxels are alike, or are no numbers")
    # of whole numbers it counts every one between the least and the largest
    shades = gray.astype(np.float32) if gray.dtype.itemsize > 2 else gray
    level = float(threshold_otsu(shades)) if threshold is None else threshold
    # Otsu's value is the last one of the darker class
    solid = gray <= level if dark else gray > level
    islands = pores = 0
    if smallest > 0:
        before = int(solid.sum())
        solid = _without_small(solid, smallest, label)
        islands = before - int(solid.sum())
        air = _without_small(~solid, smallest, label)
        pores = int((~air).sum()) - int(solid.sum())
        solid = ~air
    share = float(solid.mean())
    if not _FEWEST <= share <= _MOST:
        turned = "" if dark else ", or --dark if the solid is the darker part"
        raise CaseError(
            f"{share:.2%} of the voxels are solid at a threshold of {level:g} (gray values {gray.min():g} to "
            f"{gray.max():g}): give another --threshold{turned}"
        )
    return Segmented(solid, level, islands, pores)


def _without_small(mask: Solid, smallest: int, label: object) -> Solid:
    parts = label(mask, connectivity=1)  # type: ignore[operator]
    large = np.bincount(parts.ravel()) >= smallest
    large[0] = False
    return np.asarray(large[parts])
