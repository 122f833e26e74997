"""Predictions and comparisons as rows of text, for whoever prints them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.analytics.models.comparison import REFERENCE
from pipeline.analytics.models.prediction import Prediction
from pipeline.analytics.models.pressure_models import MODELS
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.section import Table


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


def _share(value: float) -> str:
    # a HEPA filter's efficiency is told by its nines
    return f"{value:.2%}" if value < 0.99 else f"{value:.5%}"


def _pascal(value: float | None) -> str:
    return "no answer" if value is None or value == float("inf") else f"{value:.4g}"


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
        ("solidity", _share(p.solidity)),
        ("thickness", length(p.thickness)),
        ("fiber diameter", length(p.fiber_diameter)),
        ("face velocity", f"{p.face_velocity * 100:.4g} cm/s"),
        ("temperature", f"{p.temperature:.4g} K"),
        ("viscosity", f"{p.viscosity:.4g} Pa s"),
        ("fiber Knudsen number", f"{p.knudsen:.4g} ({p.regime} flow)"),
        ("fiber Reynolds number", f"{p.reynolds:.4g}"),
    )
    drops = tuple(
        (MODELS[name].title, MODELS[name].structure, _pascal(value), "; ".join(p.notes[name]))
        for name, value in p.pressure_drop.items()
    )
    mechanisms = tuple(
        (name.replace("_", " "), f"{p.single_fiber[name]:.4g}", _share(p.efficiency[name])) for name in p.efficiency
    )
    merit = {name: "no answer" if value is None else f"{value:.4g} 1/Pa" for name, value in p.figure_of_merit.items()}
    verdict = "passes" if p.hepa["passes"] else "fails"
    results = [
        ("most penetrating size", f"{length(p.mpps['diameter'])}: {_share(p.mpps['efficiency'])}"),
        ("the same after Lee and Liu", f"{length(p.mpps['lee_liu_diameter'])}: {_share(p.mpps['lee_liu_efficiency'])}"),
        (f"figure of merit -ln(P)/dp ({p.pressure_model})", merit["a34"]),
        (f"the paper's E/dp ({p.pressure_model})", merit["paper"]),
        (
            "HEPA: 99.97 % at 300 nm, 320 Pa at 2.5 cm/s",
            f"{verdict}: {_share(float(p.hepa['efficiency'] or 0.0))}, {_pascal(p.hepa['pressure_drop'])} Pa",
        ),
    ]
    if p.aerosol["spread"] > 1.0:
        results.append((f"aerosol of spread {p.aerosol['spread']:.3g}, by count", _share(p.aerosol["count"])))
        results.append((f"aerosol of spread {p.aerosol['spread']:.3g}, by mass", _share(p.aerosol["mass"])))
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
        (row.title or name, *(_pascal(value) for value in (row.nominal, row.surface, row.mesh)), "; ".join(row.notes))
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
        (name, length(diameter), _pascal(c.models[REFERENCE].mesh * (c.fiber_diameter / diameter) ** 2))
        for name, diameter in c.fiber_diameters.items()
    )
    return (
        Table("Pressure drop [Pa] by solidity", ("model", *heads, "outside its range"), rows),
        Table("What moves it", ("part", f"of {reference}"), parts),
        Table(f"Which mean diameter is entered ({reference}, mesh)", ("mean", "diameter", "Pa"), means),
    )
