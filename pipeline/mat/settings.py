"""What a user may say about the mat: one table of settings per generator."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from pipeline.mat.tagged import OrText, by_key, key_for_text, refusal
from pipeline.units import Direction, Distance, Fraction, Length, PositiveRatio, Pressure, Ratio

LONGEST_MAT = 20_000
"""Default of `max_fibers`."""

PERIMETER_CHORD = (2 * (math.sqrt(2) + math.asinh(1)) / 3 + 1.0766359) / 3
"""Mean length of the paper's chords in sides of the square: two in three join adjacent edges (method, section 1)."""

_ISOTROPIC_CHORD = math.pi / 4
"""Mean length of uniform random chords in sides of the square (Cauchy: pi area / perimeter)."""

_NARROWEST = 0.01  # gap between the fibers of an array, in diameters
_SHALLOWEST = 0.05  # depth of an array, in diameters
_FARTHEST, _SCORES = 6.0, 400  # standard deviations beyond which no diameter counts to a moment, and places within

STOPS = ("coverage", "thickness", "solidity", "count", "pressure_drop", "efficiency")
"""The quantities that may end a mat."""

Share = Annotated[Ratio, Field(le=1)]
"""A ratio from 0 to 1, both included [-]."""

Count = Annotated[int, Field(ge=1)]
"""A whole number above 0."""


class _Settings(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


# -- diameters ---------------------------------------------------------------------------------------------


class Constant(_Settings):
    """Fibers of one diameter."""

    distribution: Literal["constant"] = "constant"
    diameter: Length = Field(description="Diameter of every fiber.")

    @property
    def mean(self) -> float:
        """Mean diameter [m]."""
        return self.diameter

    def moment(self, power: int) -> float:
        """Mean of a power of the diameter [m^power]."""
        return float(self.diameter**power)


class Uniform(_Settings):
    """Diameters spread evenly between two bounds."""

    distribution: Literal["uniform"] = "uniform"
    min: Length = Field(description="Smallest diameter.")
    max: Length = Field(description="Largest diameter.")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.min >= self.max:
            raise refusal("max", self.max, f"must exceed min = {self.min:g} m")
        return self

    @property
    def mean(self) -> float:
        """Mean diameter [m]."""
        return 0.5 * (self.min + self.max)

    def moment(self, power: int) -> float:
        """Mean of a power of the diameter [m^power]."""
        if power == -1:
            return math.log(self.max / self.min) / (self.max - self.min)
        return (self.max ** (power + 1) - self.min ** (power + 1)) / ((power + 1) * (self.max - self.min))


class _Truncated(_Settings):
    min: Length | None = Field(default=None, description="Smaller diameters are drawn again.")
    max: Length | None = Field(default=None, description="Larger diameters are drawn again.")

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest diameter that is kept [m]."""
        return (0.0 if self.min is None else self.min, math.inf if self.max is None else self.max)

    def kept(self) -> float:
        """Share of the draws that the bounds keep [-]."""
        low, high = (0.5 * (1 + math.erf(self._score(bound) / math.sqrt(2))) for bound in self.bounds)
        return high - low

    def moment(self, power: int) -> float:
        """Mean of a power of the diameter, after truncation [m^power]: by midpoints of a standard normal's scores."""
        low, high = (min(max(self._score(bound), -_FARTHEST), _FARTHEST) for bound in self.bounds)
        scores = [low + (high - low) * (k + 0.5) / _SCORES for k in range(_SCORES)]
        weights = [math.exp(-0.5 * score**2) for score in scores]
        return math.fsum(w * self._at(score) ** power for w, score in zip(weights, scores, strict=True)) / math.fsum(
            weights
        )

    def _score(self, diameter: float) -> float:
        raise NotImplementedError

    def _at(self, score: float) -> float:
        raise NotImplementedError

    @model_validator(mode="after")
    def _keeps_some(self) -> Self:
        low, high = self.bounds
        if low >= high:
            raise refusal("max", self.max, f"must exceed min = {low:g} m")
        if self.kept() < 0.01:
            raise ValueError(f"less than 1 % of this distribution lies between {low:g} m and {high:g} m")
        return self


class Normal(_Truncated):
    """Normal diameters; those below a tenth of the mean are drawn again unless `min` says otherwise."""

    distribution: Literal["normal"] = "normal"
    mean: Length = Field(description="Mean before truncation.")
    std: Length = Field(description="Standard deviation before truncation.")

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest diameter that is kept [m]."""
        return (0.1 * self.mean if self.min is None else self.min, super().bounds[1])

    def _score(self, diameter: float) -> float:
        return (diameter - self.mean) / self.std

    def _at(self, score: float) -> float:
        return self.mean + self.std * score


class Lognormal(_Truncated):
    """Lognormal diameters, by the median (the geometric mean) and the geometric standard deviation."""

    distribution: Literal["lognormal"] = "lognormal"
    median: Length = Field(description="Half of the fibers are thinner, before truncation.")
    geometric_std: Annotated[PositiveRatio, Field(gt=1, le=10)] = Field(
        description="Geometric standard deviation, above 1: 68 % lie within this factor of the median."
    )

    @property
    def mean(self) -> float:
        """Mean diameter before truncation [m]."""
        return self.median * math.exp(0.5 * math.log(self.geometric_std) ** 2)

    def _score(self, diameter: float) -> float:
        if diameter == 0:
            return -math.inf
        return math.log(diameter / self.median) / math.log(self.geometric_std)

    def _at(self, score: float) -> float:
        return self.median * float(self.geometric_std**score)


class Part(_Settings):
    """One kind of fiber in a mixture."""

    weight: PositiveRatio = Field(description="Share of the fibers by number, relative to the other parts' weights.")
    diameter: "PlainDiameters" = Field(description="Its diameters: text with a unit or a table.")


class Mixture(_Settings):
    """Fibers of several kinds, as the fine and coarse fibers of meltblown glass."""

    distribution: Literal["mixture"] = "mixture"
    parts: tuple[Part, ...] = Field(description="The kinds, two or more, each with its weight and its diameters.")

    @model_validator(mode="after")
    def _several(self) -> Self:
        if len(self.parts) < 2:
            raise refusal("parts", len(self.parts), "a mixture has two or more parts")
        return self

    @property
    def mean(self) -> float:
        """Mean diameter before truncation [m]."""
        return math.fsum(p.weight * p.diameter.mean for p in self.parts) / math.fsum(p.weight for p in self.parts)

    def moment(self, power: int) -> float:
        """Mean of a power of the diameter [m^power]."""
        total = math.fsum(part.weight for part in self.parts)
        return math.fsum(part.weight * part.diameter.moment(power) for part in self.parts) / total


_PLAIN: dict[str, type[BaseModel]] = {
    "constant": Constant,
    "normal": Normal,
    "lognormal": Lognormal,
    "uniform": Uniform,
}
PlainDiameters = Annotated[
    Constant | Normal | Lognormal | Uniform,
    by_key("distribution", _PLAIN),
    key_for_text("diameter", {"distribution": "constant"}),
    OrText("a diameter with its unit, for fibers that are all alike", "1.4 um"),
]
Diameters = Annotated[
    Constant | Normal | Lognormal | Uniform | Mixture,
    by_key("distribution", {**_PLAIN, "mixture": Mixture}),
    key_for_text("diameter", {"distribution": "constant"}),
    OrText("a diameter with its unit, for fibers that are all alike", "1.4 um"),
]
"""How fiber diameters are drawn."""

Part.model_rebuild()


# -- directions --------------------------------------------------------------------------------------------


class Perimeter(_Settings):
    """The paper's chords, from a random point of the perimeter to one on another edge (Fig. 3b)."""

    law: Literal["perimeter"] = "perimeter"


class Isotropic(_Settings):
    """Every direction in the plan alike, and the plan evenly dense."""

    law: Literal["isotropic"] = "isotropic"


class Aligned(_Settings):
    """All fibers parallel."""

    law: Literal["aligned"] = "aligned"
    axis: Direction = Field(default=0.0, description="Direction of the fibers, from x toward y.")


class VonMises(_Settings):
    """Directions spread about an axis: density proportional to exp(concentration cos 2(angle - axis))."""

    law: Literal["von_mises"] = "von_mises"
    axis: Direction = Field(default=0.0, description="Most frequent direction, from x toward y.")
    concentration: Annotated[Ratio, Field(le=1e6)] = Field(
        description="0 is isotropic; at 10 two thirds of the fibers lie within 9 degrees of the axis."
    )


class MachineDirection(_Settings):
    """The bias of a running belt: an isotropic mat stretched along the machine direction."""

    law: Literal["machine_direction"] = "machine_direction"
    axis: Direction = Field(default=0.0, description="Machine direction, from x toward y.")
    ratio: Annotated[PositiveRatio, Field(ge=1, le=1e6)] = Field(
        description="Fiber length along the machine direction over that across it, per angle; 1 is isotropic."
    )


_LAWS: dict[str, type[BaseModel]] = {
    "perimeter": Perimeter,
    "isotropic": Isotropic,
    "aligned": Aligned,
    "von_mises": VonMises,
    "machine_direction": MachineDirection,
}
Orientation = Annotated[
    Perimeter | Isotropic | Aligned | VonMises | MachineDirection,
    by_key("law", _LAWS),
    key_for_text("law", {}),
    OrText("a law that needs nothing more", "isotropic"),
]
"""How fiber directions are drawn."""


# -- the end of a mat --------------------------------------------------------------------------------------


class Stop(_Settings):
    """When a mat is complete: exactly one of the six quantities (case file: ``[mat.stop]``).

    The mat ends with the first fiber that brings the quantity to its value or beyond.

    Examples
    --------
    >>> Stop(coverage=4).quantity
    'coverage'
    """

    coverage: PositiveRatio | None = Field(
        default=None, description="Summed plan area of all fibers over the face's area; may exceed 1."
    )
    thickness: Length | None = Field(default=None, description="Height of the highest fiber's axis plus its radius.")
    solidity: Fraction | None = Field(
        default=None, description="Summed cylinder volume over the face's area times the thickness."
    )
    count: Count | None = Field(default=None, description="Number of fibers.")
    pressure_drop: Pressure | None = Field(
        default=None, description="Predicted pressure drop at the case's face velocity."
    )
    efficiency: Fraction | None = Field(
        default=None, description="Predicted share of particles held back, at `particle_diameter`."
    )
    model: str | None = Field(
        default=None,
        description="Pressure-drop model that predicts `pressure_drop` (flow.pressure_model unless given).",
    )
    particle_diameter: Length | None = Field(
        default=None, description="Particle size at which `efficiency` is meant (flow.particle_diameter unless given)."
    )

    @model_validator(mode="after")
    def _one_quantity(self) -> Self:
        given = [name for name in STOPS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"give exactly one of {', '.join(STOPS)}, not {' and '.join(given) or 'none'}")
        if self.model is not None and self.pressure_drop is None:
            raise refusal("model", self.model, f"a stop by {given[0]} predicts no pressure drop; leave it out")
        if self.particle_diameter is not None and self.efficiency is None:
            raise refusal("particle_diameter", self.particle_diameter, f"a stop by {given[0]} needs none; leave it out")
        return self

    @property
    def quantity(self) -> str:
        """Name of the quantity that ends the mat."""
        return next(name for name in STOPS if getattr(self, name) is not None)

    @property
    def target(self) -> float:
        """Its value, in SI."""
        return float(getattr(self, self.quantity))

    @property
    def predicted(self) -> bool:
        """Whether a model has to predict the quantity."""
        return self.quantity in ("pressure_drop", "efficiency")


# -- generators --------------------------------------------------------------------------------------------


class DrawnSettings(_Settings):
    """What the two random generators share."""

    side: Length = Field(description="Edge of the square plan.")
    fiber_diameter: Diameters = Field(
        description='Text like "1.4 um" for fibers of one diameter, or a table with a `distribution`.'
    )
    orientation: Orientation | None = Field(
        default=None,
        description='"perimeter" (the paper\'s chords; the default), "isotropic" (the default of a periodic mat), '
        "or a table with a `law`.",
    )
    periodic: bool = Field(
        default=False, description="Whether the plan wraps: what leaves through one side enters through the opposite."
    )
    fiber_length: Length | None = Field(
        default=None,
        description="Plan length of every fiber of a periodic mat, shorter than the side "
        "(0.869 sides unless given, the mean of the paper's chords).",
    )
    broken: Share = Field(
        default=0.0, description="Share of the fibers that end inside: these keep a random part of their chord."
    )
    seed: int = Field(default=0, ge=0, lt=2**63, description="Seed of the random numbers: the same seed, the same mat.")
    stop: Stop = Field(description="When the mat is complete: exactly one quantity.")
    max_fibers: Count = Field(default=LONGEST_MAT, description="A mat that would need more fibers is refused.")

    @property
    def law(self) -> Perimeter | Isotropic | Aligned | VonMises | MachineDirection:
        """The orientation, or the default that goes with the plan."""
        if self.orientation is not None:
            return self.orientation
        return Isotropic() if self.periodic else Perimeter()

    @property
    def wrapped_length(self) -> float:
        """Plan length of a periodic mat's fibers [m]."""
        return PERIMETER_CHORD * self.side if self.fiber_length is None else self.fiber_length

    @property
    def mean_length(self) -> float:
        """Mean plan length of a fiber, about [m]."""
        if self.periodic:
            return self.wrapped_length
        chord = PERIMETER_CHORD if isinstance(self.law, Perimeter) else _ISOTROPIC_CHORD
        return chord * self.side * (1 - 0.5 * self.broken)

    @model_validator(mode="after")
    def _plan(self) -> Self:
        if self.periodic and isinstance(self.law, Perimeter):
            raise refusal("orientation", "perimeter", "a periodic plan has no perimeter; take isotropic or another law")
        if self.periodic and self.broken > 0:
            raise refusal("broken", self.broken, "all fibers of a periodic mat end inside; set fiber_length instead")
        if not self.periodic and self.fiber_length is not None:
            raise refusal("fiber_length", self.fiber_length, "only fibers of a periodic mat have one; leave it out")
        if self.wrapped_length >= self.side:
            raise refusal("fiber_length", self.fiber_length, f"must be below the side of {self.side:g} m")
        return self

    @model_validator(mode="after")
    def _few_enough(self) -> Self:
        if self.stop.count is not None and self.stop.count > self.max_fibers:
            raise refusal("stop.count", self.stop.count, f"exceeds max_fibers = {self.max_fibers}")
        if self.stop.coverage is not None:
            count = self.stop.coverage * self.side**2 / (self.fiber_diameter.mean * self.mean_length)
            if count > self.max_fibers:
                reason = f"takes about {count:.3g} fibers, more than max_fibers = {self.max_fibers}"
                raise refusal("stop.coverage", self.stop.coverage, reason)
        return self


class LayeredSettings(DrawnSettings):
    """Fibers that drop one after the other and bend over those below (case file: ``generator = "layered"``).

    Examples
    --------
    >>> settings = LayeredSettings(side=1e-4, fiber_diameter=1.4e-6, relaxation_slope=0.15, stop=Stop(coverage=4))
    >>> settings.contact
    'paper'
    """

    generator: Literal["layered"] = Field(default="layered", description="Fibers dropped one after the other.")
    relaxation_slope: Annotated[Ratio, Field(le=1)] = Field(
        description="Steepest slope of a fiber, 0 (stiff) to 1: the paper's relaxation slope."
    )
    contact: Literal["paper", "clear"] = Field(
        default="paper",
        description="How a fiber rests on another: as in the paper, where crossing fibers overlap a little, "
        "or clear of every other fiber by the sum of the radii and the spacing.",
    )
    spacing: Distance = Field(default=0.0, description="Gap between the surfaces of fibers that rest on each other.")


class BoxSettings(DrawnSettings):
    """Straight fibers anywhere in a slab, which may pass through each other (case file: ``generator = "box"``).

    Examples
    --------
    >>> BoxSettings(side=1e-4, thickness=2e-5, fiber_diameter=1e-6, stop=Stop(solidity=0.1)).broken
    0.0
    """

    generator: Literal["box"] = Field(default="box", description="Straight fibers anywhere in a slab.")
    thickness: Length = Field(description="Extent of the slab along the flow; whole fibers lie in it.")

    @model_validator(mode="after")
    def _thickness_is_given(self) -> Self:
        if self.stop.thickness is not None:
            raise refusal("stop.thickness", self.stop.thickness, "a box has its thickness; stop by another quantity")
        return self


class ArraySettings(_Settings):
    """Parallel fibers across the flow, with symmetry planes at the sides (case file: ``generator = "array"``).

    Examples
    --------
    >>> square = ArraySettings(arrangement="square", solidity=0.1, fiber_diameter=1e-6)
    >>> round(square.pitch * 1e6, 4)
    2.8025
    """

    generator: Literal["array"] = Field(default="array", description="Parallel fibers across the flow.")
    arrangement: Literal["square", "hexagonal"] = Field(description="Where the fibers of one row stand to the next.")
    solidity: Fraction = Field(description="Fiber volume over volume, exact for the endless array.")
    fiber_diameter: Length = Field(description="Diameter of all fibers.")
    rows: Count = Field(default=1, description="Rows of fibers along the flow.")
    depth: Length | None = Field(default=None, description="Length of the fibers along y (one pitch unless given).")

    @property
    def pitch(self) -> float:
        """Distance of neighboring fibers in a row, and to the nearest fibers of the next row [m]."""
        row = self.row_pitch_ratio
        return self.fiber_diameter * math.sqrt(math.pi / (4 * self.solidity * row))

    @property
    def row_pitch_ratio(self) -> float:
        """Distance of rows over the pitch [-]."""
        return 1.0 if self.arrangement == "square" else math.sqrt(3) / 2

    @model_validator(mode="after")
    def _fits(self) -> Self:
        most = math.pi / 4 * self.row_pitch_ratio
        if self.solidity >= most:
            reason = f"a row of a {self.arrangement} array has room for its fibers below {most:.4f} only"
            raise refusal("solidity", self.solidity, reason)
        gap = self.pitch / self.fiber_diameter - 1.0
        if gap < _NARROWEST:
            reason = (
                f"leaves gaps of {gap:.2g} diameters between the fibers of a row, which no mesh resolves; "
                f"take {math.floor(1e4 * most / (1.0 + _NARROWEST) ** 2) / 1e4:.4f} or less"
            )
            raise refusal("solidity", self.solidity, reason)
        if self.depth is not None and self.depth < _SHALLOWEST * self.fiber_diameter:
            reason = (
                f"is less than {_SHALLOWEST:g} fiber diameters, and no cell fits into it; the flow is the same at any"
            )
            raise refusal("depth", self.depth, reason)
        return self


class FileSettings(_Settings):
    """A user's own fibers (case file: ``generator = "file"``); docs/mat.md describes the columns."""

    generator: Literal["file"] = Field(default="file", description="Fibers read from a CSV file.")
    file: Path = Field(description="The CSV file, one line per point of a center line.")
    side: Length | None = Field(
        default=None,
        description="Edge of the square plan, from (0, 0); unless given, the plan that the file states, "
        "or the smallest rectangle around the center lines.",
    )
    periodic: bool | None = Field(default=None, description="Whether the plan wraps; unless given, as the file says.")
    outside: Literal["refuse", "cut"] = Field(
        default="refuse",
        description="What becomes of axes that leave the slab, as those of a tomogram's window do: an error, or they "
        "are cut where they leave it.",
    )


class SurfaceFileSettings(_Settings):
    """A medium by its surface: triangles of a tomogram or of a CAD program (case file: ``generator = "surface"``)."""

    generator: Literal["surface"] = Field(default="surface", description="A closed surface read from a file.")
    file: Path = Field(description="The surface of the solid: STL, PLY, OBJ or VTP.")
    unit: Literal["nm", "um", "mm", "cm", "m"] = Field(
        description="Unit of the file's coordinates, which none of these formats tells."
    )
    side: Length | None = Field(
        default=None,
        description="Edge of the square plan, cut out of the middle; unless given, the smallest rectangle around it.",
    )


_GENERATORS: dict[str, type[BaseModel]] = {
    "layered": LayeredSettings,
    "box": BoxSettings,
    "array": ArraySettings,
    "file": FileSettings,
    "surface": SurfaceFileSettings,
}
MatSettings = Annotated[
    LayeredSettings | BoxSettings | ArraySettings | FileSettings | SurfaceFileSettings,
    by_key("generator", _GENERATORS),
]
"""The settings of whichever generator makes the mat (case file: ``[mat]``)."""
