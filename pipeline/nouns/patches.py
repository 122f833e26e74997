"""The patches of a duct: what each is called, where it lies, and what it is to the air."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import Literal

LOWER, UPPER = 0, 1
"""Ends of the duct along an axis."""


@dataclass(frozen=True, slots=True)
class DuctPatch:
    """A patch of a duct.

    Parameters
    ----------
    name : str
    role : str
        What it is to the air: ``inlet``, ``outlet``, ``side`` or ``wall``.
    axis : int, optional
        The coordinate that is the same all over it; None for the fibers.
    end : int
        At which end of the duct along that axis it lies, `LOWER` or `UPPER`.
    """

    name: str
    role: Literal["inlet", "outlet", "side", "wall"]
    axis: int | None = None
    end: int = LOWER

    @property
    def opposite(self) -> "DuctPatch":
        """The patch at the other end of its axis; LookupError for one that has no axis."""
        for other in DUCT:
            if other.axis is not None and other.axis == self.axis and other.end != self.end:
                return other
        raise LookupError(f"nothing lies opposite to {self.name}")


DUCT = (
    DuctPatch("inlet", "inlet", 2, LOWER),
    DuctPatch("outlet", "outlet", 2, UPPER),
    DuctPatch("xmin", "side", 0, LOWER),
    DuctPatch("xmax", "side", 0, UPPER),
    DuctPatch("ymin", "side", 1, LOWER),
    DuctPatch("ymax", "side", 1, UPPER),
    DuctPatch("fibers", "wall"),
)
"""The patches of a duct, in the order in which they are written."""

BY_NAME = {patch.name: patch for patch in DUCT}
PATCHES = tuple(BY_NAME)
SIDES = tuple(patch.name for patch in DUCT if patch.role == "side")
INLET, OUTLET, FIBERS = (next(p.name for p in DUCT if p.role == role) for role in ("inlet", "outlet", "wall"))
