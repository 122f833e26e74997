"""A medium that is there as a surface, in a file."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SurfaceFile:
    """Where a surface is read from, and how.

    Parameters
    ----------
    path : str
    digest : str
        Of the file's content.
    unit : float [m]
        Length of one in its coordinates.
    side : float [m], optional
        Edge of the square plan that is cut out of its middle.
    """

    path: str
    digest: str
    unit: float
    side: float | None = None
