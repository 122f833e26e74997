"""The fibers of a twin: as a picture shows them, as its measure told, or as somebody knows them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from pipeline.errors import CaseError
from pipeline.mat.settings import (
    Aligned,
    Constant,
    Isotropic,
    Lognormal,
    MachineDirection,
    Mixture,
    Normal,
    Perimeter,
    Uniform,
    VonMises,
)
from pipeline.micrograph.case import diameters_of, orientation_of, side_for
from pipeline.micrograph.laws import DiameterLaw, OrientationLaw
from pipeline.micrograph.measure import measure
from pipeline.microscope.read import read_micrograph
from pipeline.reading import read_bytes
from pipeline.twin.measurement import Measurement
from pipeline.twin.settings import MeasuredFilter

_LARGEST_JSON = 50_000_000
_PARAMETERS = {
    "normal": {"mean", "std"},
    "lognormal": {"median", "geometric_std"},
    "mixture": {"share", "median_1", "geometric_std_1", "median_2", "geometric_std_2"},
}

Diameters = Constant | Uniform | Normal | Lognormal | Mixture
Directions = Perimeter | Isotropic | Aligned | VonMises | MachineDirection


@dataclass(frozen=True, slots=True)
class FiberLaws:
    """What is known of a filter's fibers.

    Parameters
    ----------
    diameters : settings of a distribution
    directions : settings of a law
    mean : Measurement [m]
        Of the diameters, each fiber counted once.
    side : float [m]
        Edge of a plan with room for enough of them.
    origin : str
        In words.
    picture : Path, optional
        The micrograph, where it is at hand, and the length of its pixel [m].
    pixel : float, optional
    """

    diameters: Diameters
    directions: Directions
    mean: Measurement
    side: float
    origin: str
    picture: Path | None = None
    pixel: float | None = None


def fibers_of(measured: MeasuredFilter) -> FiberLaws:
    """Tell which fibers a filter has.

    Raises
    ------
    CaseError
        If the picture cannot be measured, or its JSON is none of ``fibertwin measure --json``.
    """
    if measured.micrograph is None:
        assert measured.fiber_diameter is not None
        law = measured.fiber_diameter
        found = FiberLaws(
            law,
            Isotropic(),
            Measurement(law.mean, measured.diameter_tolerance * law.mean),
            side_for(law.mean),
            "as given",
        )
    elif measured.micrograph.suffix.lower() == ".json":
        found = _told(measured.micrograph)
    else:
        found = _seen(measured.micrograph, measured.pixel, measured.bar)
    return found if measured.orientation is None else replace(found, directions=measured.orientation)


def scaled(law: Diameters, factor: float) -> Diameters:
    """Give the same distribution of diameters that are all larger by a factor."""
    if isinstance(law, Mixture):
        parts = tuple(part.model_copy(update={"diameter": scaled(part.diameter, factor)}) for part in law.parts)
        return law.model_copy(update={"parts": parts})
    names = [name for name in ("diameter", "mean", "std", "median", "min", "max") if name in type(law).model_fields]
    lengths = {name: getattr(law, name) for name in names}
    return law.model_copy(update={name: value * factor for name, value in lengths.items() if value is not None})


def _seen(path: Path, pixel: float | None, bar: float | None) -> FiberLaws:
    picture = read_micrograph(path, pixel, bar)
    seen = measure(picture)
    return FiberLaws(
        diameters=diameters_of(seen.laws[0]),
        directions=orientation_of(seen.orientation),
        mean=_of_interval(seen.mean.value, seen.mean.low, seen.mean.high),
        side=side_for(seen.length_mean),
        origin=f"{seen.fibers} fibers of {path.name}",
        picture=path,
        pixel=picture.pixel,
    )


class _Read(BaseModel):
    model_config = ConfigDict(allow_inf_nan=False)


class _Law(_Read):
    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, float]
    name: str


class _Directions(_Read):
    law: str
    axis: float
    concentration: float = Field(ge=0, le=1e6)
    order: float


class _Weighted(_Read):
    mean: float = Field(gt=0, lt=1)


class _Told(_Read):
    mean: float = Field(gt=0, lt=1)
    mean_interval: tuple[float, float]
    length_weighted: _Weighted
    laws: list[_Law] = Field(min_length=1)


class _Json(_Read):
    """What is read of the JSON of ``fibertwin measure``."""

    fibers: int = Field(ge=1)
    diameter: _Told
    orientation: _Directions
    picture: str
    pixel: float = Field(gt=0, lt=1)


def _told(path: Path) -> FiberLaws:
    try:
        told = _Json.model_validate(json.loads(read_bytes(path, _LARGEST_JSON)))
        law = _law(told.diameter.laws[0])
    except OSError as problem:
        raise CaseError(f"cannot read {path}: {problem.strerror}") from problem
    except (ValidationError, ValueError, RecursionError) as problem:
        reason = problem.errors()[0]["msg"] if isinstance(problem, ValidationError) else str(problem)
        raise CaseError(
            f"{path} is not what fibertwin measure --json tells of a picture ({reason}); make it with "
            f'fibertwin measure web.png --pixel "25 nm" --json > {path.name}'
        ) from None
    way = told.orientation
    picture = Path(told.picture)
    return FiberLaws(
        diameters=diameters_of(law),
        directions=orientation_of(OrientationLaw(way.law, way.axis, way.concentration, way.order)),
        mean=_of_interval(told.diameter.mean, *told.diameter.mean_interval),
        side=side_for(told.diameter.length_weighted.mean),
        origin=f"{told.fibers} fibers of {picture.name}",
        picture=picture if picture.is_file() else None,
        pixel=told.pixel,
    )


def _law(told: _Law) -> DiameterLaw:
    parameters = {name: value for name, value in told.__pydantic_extra__.items() if name != "aic"}
    if set(parameters) != _PARAMETERS.get(told.name) or not all(0 < each < math.inf for each in parameters.values()):
        raise ValueError(f"a law {told.name!r} of diameters with {', '.join(parameters) or 'nothing'}")
    return DiameterLaw(told.name, parameters, 0.0)


def _of_interval(value: float, low: float, high: float) -> Measurement:
    # many fibers leave a narrow interval, but a measure of a picture itself is off by up to 3 % (docs/measuring.md)
    return Measurement(value, min(max(high - value, value - low, 0.03 * value), 0.5 * value))
