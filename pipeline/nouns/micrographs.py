"""Pictures of a mat from above, and of the real medium beside it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

from pipeline.nouns.arrays import require


@dataclass(frozen=True, slots=True)
class Micrographs:
    """Files of a run's micrographs, which show as much as each other.

    Parameters
    ----------
    twin : str
        File of the mat's picture, beside this noun's own.
    measured : str, optional
        That of the real medium.
    pixel : float [m]
        Edge of a pixel of both.
    width, height : float [m]
        Of what they show.
    """

    twin: str
    measured: str | None
    pixel: float
    width: float
    height: float

    def __post_init__(self) -> None:
        for name in (self.twin, self.measured):
            # the folder may be a stranger's: no name leads out of it
            require(name is None or name in ("twin.png", "measured.png"), f"{name!r} is no picture of a run")
        require(self.pixel > 0 and self.width > 0 and self.height > 0, "a picture has a size")
