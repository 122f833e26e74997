"""An axis-aligned box in space."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Box:
    """An axis-aligned box with a volume.

    Parameters
    ----------
    lower, upper : tuple of 3 floats [m]
        Opposite corners; each coordinate of `upper` exceeds that of `lower`.

    Raises
    ------
    ValueError
        If the box has no volume.

    Examples
    --------
    >>> Box((0, 0, 0), (2, 3, 4)).volume
    24
    """

    lower: tuple[float, float, float]
    upper: tuple[float, float, float]

    def __post_init__(self) -> None:
        if not all(low < high for low, high in zip(self.lower, self.upper, strict=True)):
            raise ValueError(f"the box from {self.lower} to {self.upper} has no volume")

    @property
    def size(self) -> tuple[float, float, float]:
        """Edge lengths along x, y and z [m]."""
        (x0, y0, z0), (x1, y1, z1) = self.lower, self.upper
        return (x1 - x0, y1 - y0, z1 - z0)

    @property
    def volume(self) -> float:
        """Volume [m3]."""
        x, y, z = self.size
        return x * y * z

    @property
    def face_area(self) -> float:
        """Area of the face that the flow along z meets [m2]."""
        x, y, _ = self.size
        return x * y

    def extended(self, below: float, above: float) -> "Box":
        """Give the box with `below` more length at its lower z and `above` more at its upper z [m]."""
        (x0, y0, z0), (x1, y1, z1) = self.lower, self.upper
        return Box((x0, y0, z0 - below), (x1, y1, z1 + above))
