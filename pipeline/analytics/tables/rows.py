"""Predictions and comparisons as rows of text, for whoever prints them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

from pipeline.analytics.formulas.cell import hydrodynamic_factor
from pipeline.analytics.formulas.classes import en_1822_class, iso_29463_class
from pipeline.analytics.formulas.merit import HEPA_EFFICIENCY, HEPA_PRESSURE_DROP
from pipeline.analytics.models.comparison import REFERENCE
from pipeline.analytics.models.prediction import Prediction
from pipeline.analytics.models.pressure_models import MODELS
from pipeline.analytics.models.single_fiber import PRESETS
from pipeline.analytics.models.thick import ThickMedium
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.section import Table

_TOLD_BY_PENETRATION = 0.99
_LEAST_PENETRATION = 1e-6  # percent; below, digits of the efficiency are nines only


_SEEN = 0.005
_NOTHING = 1e-9
"""Penetration below which a number would say more than is known."""


def length(value: float) -> str:
    """Write a length in the unit that suits it.

    Examples
    --------
    >>> length(2.154e-7), length(1.4e-6), length(1e-3)
    ('215.4 nm', '1.4 um', '1 mm')
    """
    for unit, size in (("mm", 1e-3), ("um", 1e-6)):
        if value >= size * (1 - 1e-12):
            return f"{value / size:.4g} {unit}"
    return f"{value / 1e-9:.4g} nm"


def share(value: float) -> str:
    """Write an efficiency as people in filtration do: from 99 % on by what it lets through.

    Examples
    --------
    >>> share(0.4534), share(0.99975), share(1.0 - 3.2e-9)
    ('45.34%', '99.975% (penetration 0.025%)', 'penetration 3.2e-07%')
    """
    passing = 100.0 * (1.0 - value)
    if value < _TOLD_BY_PENETRATION:
        return f"{value:.2%}"
    if passing < _LEAST_PENETRATION:
        return f"penetration {passing:.2g}%" if passing > 0.0 else "100%"
    digits = max(0, 1 - math.floor(math.log10(passing)))
    return f"{100.0 * value:.{digits}f}% (penetration {passing:.3g}%)"


def pascal(value: float | None) -> str:
    """Write a pressure drop with four digits, whatever its size.

    Examples
    --------
    >>> pascal(22.0), pascal(20.936), pascal(10514.7), pascal(None)
    ('22.00', '20.94', '10,510', 'no answer')
    """
    if value is None or not math.isfinite(value):
        return "no answer"
    digits = 3 - math.floor(math.log10(value)) if value > 0.0 else 0
    return f"{round(value, digits):,.{max(0, digits)}f}"


def prediction_tables(prediction: Prediction) -> tuple[Table, ...]:
    """Lay a prediction out as tables: the filter, pressure drop, efficiency, what follows from them.

    Parameters
    ----------
    prediction : Prediction

    Returns
    -------
    tuple of Table
    """
    p = prediction
    medium = (
        ("solidity", f"{p.solidity:.2%}"),
        ("thickness", length(p.thickness)),
        ("fiber diameter", length(p.fiber_diameter)),
        ("face velocity", f"{p.face_velocity * 100:.4g} cm/s"),
        ("temperature", f"{p.temperature:.4g} K"),
        ("viscosity", f"{p.viscosity:.4g} Pa s"),
        ("fiber Knudsen number", f"{p.knudsen:.4g} ({p.regime} flow)"),
        ("fiber Reynolds number", f"{p.reynolds:.4g}"),
    )
    drops = tuple(
        (MODELS[name].title, MODELS[name].structure, pascal(value), "; ".join(p.notes[name]))
        for name, value in p.pressure_drop.items()
    )
    mechanisms = tuple(
        (name.replace("_", " "), f"{p.single_fiber[name]:.4g}", share(p.efficiency[name])) for name in p.efficiency
    )
    merit = {name: "no answer" if value is None else f"{value:.4g} 1/Pa" for name, value in p.figure_of_merit.items()}
    results = [
        ("most penetrating size", f"{length(p.mpps['diameter'])}: {share(p.mpps['efficiency'])}"),
        ("the same after Lee and Liu", f"{length(p.mpps['lee_liu_diameter'])}: {share(p.mpps['lee_liu_efficiency'])}"),
        (f"figure of merit -ln(P)/dp ({p.pressure_model})", merit["a34"]),
        (f"the paper's E/dp ({p.pressure_model})", merit["paper"]),
        *_classes(p),
        ("HEPA: at least 99.97 % at 300 nm, at most 320 Pa at 2.5 cm/s", _hepa(p)),
    ]
    if p.aerosol["spread"] > 1.0:
        results.append((f"aerosol of spread {p.aerosol['spread']:.3g}, by count", share(p.aerosol["count"])))
        results.append((f"aerosol of spread {p.aerosol['spread']:.3g}, by mass", share(p.aerosol["mass"])))
    results += _about_slip(p)
    results.extend(("warning", text) for text in p.warnings)
    return (
        Table("Filter", ("", ""), medium),
        Table("Pressure drop", ("model", "medium", "Pa", "outside its range"), drops),
        Table(
            f"Efficiency at {length(p.particle_diameter)} ({p.preset})",
            ("mechanism", "single fiber", "filter, alone"),
            mechanisms,
        ),
        Table("Filter performance", ("", ""), tuple(results)),
    )


def _about_slip(p: Prediction) -> list[tuple[str, str]]:
    """Say what the paper's slip term does to interception, where it does more than one can read off."""
    lowered = p.knudsen / (float(hydrodynamic_factor(p.solidity)) + p.knudsen)
    if PRESETS[p.preset].interception != "slip" or lowered < _SEEN:
        return []
    told = f"lowers interception by {lowered:.0%}, where slip would raise it; --preset hinds leaves it out"
    return [(f"slip in the preset {p.preset} (Eq. A11)", told)]


def _classes(p: Prediction) -> list[tuple[str, str]]:
    """Classes of the medium by its penetration at the most penetrating size."""
    penetration = 1.0 - p.mpps["efficiency"]
    european, international = en_1822_class(penetration), iso_29463_class(penetration)
    if european is None:
        return [("class at that size", "below E10 of EN 1822")]
    return [("class at that size", f"{european} of EN 1822, {international} of ISO 29463 (of the medium)")]


def _hepa(p: Prediction) -> str:
    efficiency, drop = float(p.hepa["efficiency"] or 0.0), p.hepa["pressure_drop"]
    found = f"{share(efficiency)}, {pascal(drop)} Pa"
    if p.hepa["passes"]:
        return f"passes: {found}"
    broken = []
    if efficiency < HEPA_EFFICIENCY:
        broken.append(f"efficiency below {HEPA_EFFICIENCY:.2%}")
    if drop is None or drop > HEPA_PRESSURE_DROP:
        broken.append(f"pressure drop above {HEPA_PRESSURE_DROP:g} Pa")
    return f"fails, {' and '.join(broken)}: {found}"


def thick_tables(medium: ThickMedium) -> tuple[Table, ...]:
    """Lay a scaled slab out as tables: its drop with its interval, what the interval is made of, and what passes.

    Parameters
    ----------
    medium : ThickMedium

    Returns
    -------
    tuple of Table
    """
    m = medium
    slabs = "a slab" if m.slabs == 1 else f"{m.slabs} slabs"
    rows = (
        ("thickness", f"{length(m.thickness)}, from {slabs} of {length(m.slab_thickness)}"),
        ("face velocity", f"{100.0 * m.face_velocity:.4g} cm/s"),
        ("pressure drop", f"{pascal(m.pressure_drop)} Pa, {pascal(m.low)} to {pascal(m.high)} Pa"),
        ("in proportion to thickness it would be", f"{pascal(m.by_proportion)} Pa"),
    )
    shares = tuple((each.name, f"±{each.half_width / m.pressure_drop:.1%}", each.source) for each in m.shares)
    if not any(each.name == "another piece of the medium" for each in m.shares):
        shares += (("another piece of the medium", "not known", "give several runs of other seeds: --from A --from B"),)
    found = [Table("Thick medium", ("", ""), rows), Table("Its interval", ("part", "of it", "from"), shares)]
    if m.particle_diameter:
        each = zip(m.particle_diameter, m.penetration, m.penetration_low, m.penetration_high, strict=True)
        passing = tuple(
            (length(size), _passing(value), f"{_passing(low)} to {_passing(high)}") for size, value, low, high in each
        )
        found.append(Table("What passes", ("particle", "penetration", "95 % of the slab's counts"), passing))
    return tuple(found)


def _passing(penetration: float) -> str:
    return f"{100.0 * penetration:.3g}%" if penetration >= _NOTHING else f"below {100.0 * _NOTHING:g}%"


def comparison_tables(comparison: Comparison) -> tuple[Table, ...]:
    """Lay a comparison out as tables: pressure drop by model and solidity, what moves it, and by mean diameter.

    Parameters
    ----------
    comparison : Comparison

    Returns
    -------
    tuple of Table
    """
    c = comparison
    rows = tuple(
        (row.title or name, *(pascal(value) for value in (row.nominal, row.surface, row.mesh)), "; ".join(row.notes))
        for name, row in c.models.items()
    )
    heads = tuple(f"{name} {share:.3%}" for name, share in c.solidity.items())
    a = c.attribution
    parts = (
        ("overlap of the fibers (surface against nominal)", f"{a['overlap']:+.2%}"),
        ("meshing (mesh against surface)", f"{a['meshing']:+.2%}"),
        ("choice of model (those in their solidity range)", f"{a['model_low']:+.0%} to {a['model_high']:+.0%}"),
    )
    reference = MODELS[REFERENCE].title
    means = tuple(
        (name, length(diameter), pascal(c.models[REFERENCE].mesh * (c.fiber_diameter / diameter) ** 2))
        for name, diameter in c.fiber_diameters.items()
    )
    return (
        Table("Pressure drop [Pa] by solidity", ("model", *heads, "outside its range"), rows),
        Table("What moves it", ("part", f"of {reference}"), parts),
        Table(f"Which mean diameter is entered ({reference}, mesh)", ("mean", "diameter", "Pa"), means),
    )
