"""What the studies of the permeability of layered random mats left: one row a mat, and one a mat and Knudsen number."""

# SPDX-License-Identifier: GPL-3.0-or-later

import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.line.places import MANIFEST
from pipeline.line.run import Run
from pipeline.line.store import read_json, write_json
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.study.plan import RESULTS, WORK
from pipeline.units import parse
from validation.slip_sweep import permeability_gains

ROOT = Path(__file__).parents[1]
STUDIES = tuple(
    ROOT / "cases" / "studies" / f"permeability{part}.toml" for part in ("", "_sides", "_small", "_coverage")
)
"""The kinds of mats first, then the plans, then the thicknesses of one of them."""
DATA = ROOT / "docs" / "data" / "permeability.csv"
SLIP_DATA = ROOT / "docs" / "data" / "permeability_slip.csv"
KNUDSEN = (0.02, 0.05, 0.1, 0.2)
"""Mean free paths over fiber radius at which mats of the first study are solved on the same mesh."""
SLIP_SEEDS = 2
"""Seeds of each kind that are: by how much slip helps varies little from mat to mat."""
SWEPT = "slip.json"
_SLOPE, _COVERAGE = 0.15, 2.0


@dataclass(frozen=True, slots=True)
class Measured:
    """One mat.

    Parameters
    ----------
    study : str
    side : float [-]
        Of the plan, in fiber diameters.
    coverage : float [-]
        Plan area of all fibers over that of the mat, at which it stopped.
    slope : float [-]
        Relaxation slope.
    contact : str
    spacing : float [-]
        Least gap between fibers in diameters.
    seed : int
    solidity : float [-]
        Of the mesh.
    thickness : float [-]
        In fiber diameters.
    cells : int
    permeability : float [-]
        Without slip, over the squared fiber radius.
    knudsen : float [-]
        Mean free path over fiber radius.
    permeability_slip : float [-]
        With slip at that Knudsen number, over the squared fiber radius.
    """

    study: str
    side: float
    coverage: float
    slope: float
    contact: str
    spacing: float
    seed: int
    solidity: float
    thickness: float
    cells: int
    permeability: float
    knudsen: float
    permeability_slip: float


@dataclass(frozen=True, slots=True)
class Slipping:
    """One mat at one Knudsen number, on the mesh that it had without slip.

    Parameters
    ----------
    slope : float [-]
    contact : str
    spacing : float [-]
        In fiber diameters.
    seed : int
    solidity : float [-]
    knudsen : float [-]
    gain : float [-]
        Permeability with slip over that without, less 1.
    """

    slope: float
    contact: str
    spacing: float
    seed: int
    solidity: float
    knudsen: float
    gain: float


def _made(result: Path) -> dict[str, Any]:
    made: dict[str, Any] = tomllib.loads("\n".join(read_json(result.parent / MANIFEST)["set"]))["mat"]
    return made


def measured(folder: Path) -> Iterator[Measured]:
    """Read the finished runs of a study."""
    for path in sorted((folder / RESULTS).glob("*/result.json")):
        found, made = read_json(path), _made(path)
        solve, compare, mat = found["solve"], found["compare"], found["mat"]
        diameter = compare["fiber_diameter"]
        slip = solve["permeability"] / (0.5 * diameter) ** 2
        yield Measured(
            study=folder.name,
            side=parse(made["side"], "m") / diameter,
            coverage=made.get("stop", {}).get("coverage", _COVERAGE),
            slope=made.get("relaxation_slope", _SLOPE),
            contact=made["contact"],
            spacing=parse(made["spacing"], "m") / diameter,
            seed=made["seed"],
            solidity=compare["solidity"]["mesh"],
            thickness=mat["thickness"] / diameter,
            cells=found["tetmesh"]["cells"],
            permeability=slip * solve["pressure_drop_slip"] / solve["pressure_drop_no_slip"],
            knudsen=compare["knudsen"],
            permeability_slip=slip,
        )


def slipping(folder: Path) -> Iterator[Slipping]:
    """Read the mats of a study that were solved at several Knudsen numbers."""
    for path in sorted((folder / WORK).glob(f"*/{SWEPT}")):
        result = folder / RESULTS / path.parent.name / "result.json"
        made, compare = _made(result), read_json(result)["compare"]
        for kn, gain in read_json(path):
            yield Slipping(
                slope=made.get("relaxation_slope", _SLOPE),
                contact=made["contact"],
                spacing=parse(made["spacing"], "m") / compare["fiber_diameter"],
                seed=made["seed"],
                solidity=compare["solidity"]["mesh"],
                knudsen=kn,
                gain=gain,
            )


def sweep_slip(folder: Path, tell: Callable[[str], None]) -> None:
    """Solve the meshes that a study kept at each of `KNUDSEN`, where that is not done."""
    for work in sorted((folder / WORK).glob("*/")):
        if (folder / RESULTS / work.name / "result.json").is_file() and not (work / SWEPT).is_file():
            tell(f"{folder.name}, {work.name}: {len(KNUDSEN)} Knudsen numbers on one mesh")
            run = Run.opened(work)
            gains = permeability_gains(run.read(FaceMesh), run.read(FluidDomain), run.case.enclosure.sides, KNUDSEN)
            write_json(work / SWEPT, list(zip(KNUDSEN, gains, strict=True)))
