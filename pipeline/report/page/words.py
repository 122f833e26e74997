"""What the numbers of a run mean, in sentences: what was made, whether to trust it, what to do next."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import shlex
from dataclasses import dataclass

from pipeline.analytics.tables.rows import length
from pipeline.line.results import Results
from pipeline.mat.settings import LayeredSettings
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import QualityReport

GOOD, NOTE, BAD = "good", "note", "bad"
_FLUX_ERROR = 0.01
"""Drag and pressure of a settled solution differ by less than this share."""


@dataclass(frozen=True, slots=True)
class Check:
    """One thing that decides whether to trust a run: `mark` is good, note or bad."""

    mark: str
    title: str
    sentence: str


@dataclass(frozen=True, slots=True)
class Step:
    """What to do next, and the command that does it."""

    sentence: str
    command: str = ""


def checks(content: Results) -> list[Check]:
    """Judge everything that is there."""
    found = []
    if content.left_out:
        found.append(
            Check(
                NOTE,
                "older results left out",
                f"{', '.join(content.left_out)}: made from another case, or before an earlier stage was made again.",
            )
        )
    quality, comparison, mat = content.get(QualityReport), content.get(Comparison), content.get(Mat)
    solution = content.get(Solution)
    if quality is not None:
        found.append(cells(quality))
    if comparison is not None:
        found += _solidities(content, comparison)
    if mat is not None:
        found.append(_piece(mat))
    if comparison is not None:
        found += _models(comparison, solution)
    if solution is not None:
        found += _solver(solution)
    return found


def verdict(quality: QualityReport | None) -> tuple[str, str]:
    """Give the mark and the words of a mesh."""
    if quality is None:
        return NOTE, "no mesh yet"
    placed = ", every fiber is in its place" if quality.fibers else ""
    return {
        "pass": (GOOD, f"mesh is fit for a solver{placed}"),
        "warn": (NOTE, "mesh is usable, with a loss of accuracy"),
        "fail": (BAD, "mesh is not fit for a solver"),
    }[quality.verdict]


def whole_verdict(content: Results) -> tuple[str, str]:
    """Give the mark and the words of a run: the mesh's verdict, and the solution's where there is one."""
    (mark, mesh), solution = verdict(content.get(QualityReport)), content.get(Solution)
    if solution is None:
        return mark, mesh
    if not solution.converged:
        return BAD, f"{mesh}, but the flow has not settled"
    balanced = _balanced(solution)
    words = "the flow has settled and balances" if balanced else "the flow has settled but does not balance"
    return (mark if balanced or mark == BAD else NOTE), f"{mesh}, {words}"


def _balanced(solution: Solution) -> bool:
    return abs(solution.force_balance_error) < _FLUX_ERROR and abs(solution.mass_balance_error) < _FLUX_ERROR


def cells(report: QualityReport) -> Check:
    """Say whether a solver can take the mesh, and every limit that does not hold."""
    mark, title, words = {
        "pass": (GOOD, "the mesh is fit for a solver", "Every limit holds, in every cell and face."),
        "warn": (
            NOTE,
            "the mesh is usable",
            "Solvers take it; where a limit is broken the answer loses accuracy.",
        ),
        "fail": (BAD, "the mesh is not fit for a solver", "It may diverge or be wrong where limits are broken."),
    }[report.verdict]
    return Check(mark, title, " ".join([words, *(f"{text[:1].upper()}{text[1:]}." for text in report.reasons)]))


def _solidities(content: Results, c: Comparison) -> list[Check]:
    meshing, overlap = c.attribution.get("meshing", 0.0), c.attribution.get("overlap", 0.0)
    kept = c.solidity["mesh"] / c.solidity["surface"] - 1.0
    # the case says how much of the fibers' volume the mesh may lose
    allowed = content.case.tetmesh.volume_error
    fine = abs(kept) <= allowed
    advice = "" if fine else f"; {content.case.tetmesh.mesher.truer}"
    return [
        Check(
            GOOD if fine else BAD,
            "what meshing costs",
            f"The fibers' volume in the mesh is {kept:+z.3%} off that of their surface (allowed: {allowed:.2%}), which "
            f"moves the models' pressure drop by {meshing:+z.3%}{advice}.",
        ),
        Check(
            NOTE if abs(overlap) > allowed else GOOD,
            "what the fibers' overlap costs",
            f"Fibers that share space are counted twice in the nominal solidity of {c.solidity['nominal']:.2%}; "
            f"the united surface has {c.solidity['surface']:.2%}, which moves the pressure drop by {overlap:+z.2%}."
            + _clearance(content, overlap, allowed),
        ),
    ]


def _clearance(content: Results, overlap: float, allowed: float) -> str:
    mat = content.case.mat
    overlapping = isinstance(mat, LayeredSettings) and mat.contact == "paper"
    return ' With mat.contact = "clear" fibers touch but do not overlap.' if overlapping and overlap < -allowed else ""


def _piece(mat: Mat) -> Check:
    side = min(mat.slab.size[:2])
    diameter = 2.0 * float(mat.radius.mean())
    return Check(
        NOTE,
        "how large a piece this is",
        f"The face is {length(side)} wide, {side / diameter:.0f} fiber diameters, with {mat.fibers:,} fibers. "
        "How much another piece of the same medium differs only other seeds can tell: --set mat.seed=2.",
    )


def _models(c: Comparison, solution: Solution | None) -> list[Check]:
    low, high = c.attribution.get("model_low", 0.0), c.attribution.get("model_high", 0.0)
    answer = "Only a solved flow decides for this mat."
    if solution is not None:
        change = solution.pressure_drop / c.models["davies"].mesh - 1.0
        answer = f"For this mat the solved flow differs from Davies' by {change:+.0%}."
    found = [
        Check(
            NOTE,
            "which model is right",
            f"Models that hold for this solidity differ from Davies' by {low:+.0%} to {high:+.0%}: "
            f"they are for other arrangements of fibers. {answer}",
        )
    ]
    if c.regime and not c.regime.startswith("continuum"):
        found.append(
            Check(
                NOTE,
                f"{c.regime} flow around the fibers",
                f"At a Knudsen number of {c.knudsen:.3g} air slips along the fibers; models and solvers without slip "
                "give a pressure drop that is too high (the notes in the table say by how much).",
            )
        )
    return found


def _solver(solution: Solution) -> list[Check]:
    balanced = _balanced(solution)
    return [
        Check(
            GOOD if solution.converged else BAD,
            "the solution has settled" if solution.converged else "the solution has not settled",
            f"{solution.pressure_drop:.4g} Pa after {solution.iterations:,} iterations"
            + ("." if solution.converged else "; let it run on: raise solve's limit of iterations."),
        ),
        Check(
            GOOD if balanced else NOTE,
            "balance of forces and of mass",
            f"The fibers' drag differs by {solution.force_balance_error:+z.2%} from pressure drop times face area, "
            f"outflow from inflow by {solution.mass_balance_error:+.2g}.",
        ),
    ]


def steps(content: Results) -> list[Step]:
    """Say what to do next."""
    folder = shlex.quote(str(content.folder))
    quality, comparison = content.get(QualityReport), content.get(Comparison)
    found = []
    if comparison is None or content.get(FaceMesh) is None:
        found.append(Step("This run is not complete; the same command goes on.", f"fibertwin run CASE --out {folder}"))
    if quality is not None and quality.verdict == "fail":
        mesh = content.case.tetmesh
        overrides = "".join(f" --set {shlex.quote(override)}" for override in mesh.mesher.better(mesh))
        found.append(
            Step(
                "Mend the mesh before solving: let the mesher do more, or take another seed; "
                "clearance between fibers spares the sharp crevices that make most bad cells.",
                f"fibertwin run CASE --out {folder}{overrides}",
            )
        )
    exported = content.manifests().get("export", {}).get("counts", {}).get("formats", ())
    if content.get(FaceMesh) is not None and content.get(Solution) is None:
        found.append(Step("Solve the flow.", f"fibertwin solve {folder}"))
    if content.get(Mat) is not None:
        found.append(Step("Turn the geometry and the mesh in a window.", f"fibertwin view {folder}"))
        found.append(
            Step("Send them as one file that turns in any browser.", f"fibertwin view {folder} --html model.html")
        )
    if (content.folder / "solve" / "flow.vtu").is_file():
        script = f"{folder}/solve/open_in_paraview.py"
        found.append(Step("Open speed, pressure and streamlines in ParaView.", f"paraview --script={script}"))
    elif "vtk" in exported:
        found.append(Step("Open the mesh and its quality in ParaView.", f"paraview {folder}/export/vtk/mesh.vtm"))
    if comparison is not None:
        found.append(
            Step(
                "Ask the models for other particles or velocities.",
                f"fibertwin predict {folder} --particle-diameter 1um",
            )
        )
    return found


def finite(value: float, unit: str = "") -> str:
    """Write a number that a model may have no answer for.

    Examples
    --------
    >>> finite(6.60912, "Pa"), finite(math.inf, "Pa")
    ('6.609 Pa', 'no answer')
    """
    return f"{value:.4g} {unit}".strip() if math.isfinite(value) else "no answer"
