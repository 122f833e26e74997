"""The commands of `fibertwin`."""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib.metadata
import json
import os
import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, CycloptsError, Parameter
from rich.console import Console

from pipeline.cli import completing
from pipeline.cli.bundled import found
from pipeline.cli.printable import printable
from pipeline.errors import CaseError, FibertwinError
from pipeline.reading import is_text

app = App(
    name="fibertwin",
    help="From a fiber mat to a CFD case one can trust: one TOML file in, a checked OpenFOAM case out.",
    version=lambda: importlib.metadata.version("fibertwin"),
    version_flags=["--version"],
    # that a switch is off and a list empty goes without saying
    # an interruption has an end of its own (pipeline/cli/interruption.py)
    suppress_keyboard_interrupt=False,
    default_parameter=Parameter(show_default=lambda value: None if value in (False, ()) else value),
)
app.register_install_completion_command()
out = Console()
err = Console(stderr=True)

CaseFile = Annotated[Path, Parameter(completer=completing.cases)]
RunFolder = Annotated[Path, Parameter(completer=completing.runs)]

WRONG_USE = 2
"""Exit code of a command line that asks for nonsense."""


@app.command
def run(
    case: CaseFile,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    until: Annotated[str | None, Parameter(completer=completing.stages)] = None,
    set_: Annotated[tuple[str, ...], Parameter(name=["--set", "-s"], negative="", consume_multiple=False)] = (),
    force: Annotated[tuple[str, ...], Parameter(negative="", consume_multiple=False, completer=completing.stages)] = (),
    dry_run: Annotated[bool, Parameter(negative="")] = False,
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Run a case through the line: mat, surface, enclosure, tetmesh, quality, export, compare, report.

    Finished stages are reused while nothing they depend on has changed, so a run that was stopped continues; why a
    stage ran is said.

    Parameters
    ----------
    case
        The case file (TOML), or the name of a bundled case: ``fibertwin cases`` lists them.
    out
        Folder of this run; ``runs/<name of the case file>`` if left out.
    until
        Last stage to run: mat, micrograph, surface, structure, enclosure, tetmesh, quality, export, compare, solve,
        capture or report; report if left out. Micrograph, structure, solve and capture run only where the case file
        has their table, or this says so.
    set_
        Override a key of the case file: ``--set mat.seed=7``. May be repeated.
    force
        Make this stage again even if its result still holds. May be repeated.
    dry_run
        Do nothing; tell what would run and why, with an estimate of cells, memory and processor time.
    as_json
        Print JSON instead of tables: of each stage its folder, what became of it and why, its seconds, and its counts
        in SI units.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.running import run_case

    run_case(found(case), out or Path("runs") / case.stem, until, set_, force, as_json, quiet, dry_run)


@app.command
def solve(
    run: RunFolder,
    *,
    set_: Annotated[tuple[str, ...], Parameter(name=["--set", "-s"], negative="", consume_multiple=False)] = (),
    again: Annotated[bool, Parameter(negative="")] = False,
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Solve the flow of a run that is there; a solution by OpenFOAM that was stopped continues.

    Parameters
    ----------
    run
        The folder of a run; stages that it lacks are made first.
    set_
        Override a key of solve: ``--set solve.stokes.tolerance=1e-5`` or ``--set solve.engine=openfoam``.
        May be repeated.
    again
        Solve again even if the solution still holds.
    as_json
        Print the solution as JSON with SI numbers.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.solving import solve_run

    solve_run(run, set_, again, as_json, quiet)


@app.command
def export(
    run: RunFolder,
    *,
    format_: Annotated[
        tuple[str, ...],
        Parameter(name=["--format", "-f"], negative="", consume_multiple=False, completer=completing.formats),
    ] = (),
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    set_: Annotated[tuple[str, ...], Parameter(name=["--set", "-s"], negative="", consume_multiple=False)] = (),
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Write files of a run that is there, in any format, without running it again.

    Parameters
    ----------
    run
        The folder of a run.
    format_
        openfoam, vtk, fluent, gmsh, abaqus, nastran, su2 or medit for the mesh; stl, ply or obj for the fibers'
        surface; csv or spaceclaim for their center lines. May be repeated.
    out
        Folder that gets a folder per format; ``RUN/export`` if left out.
    set_
        Override a key of export: ``--set export.length_unit=mm``. May be repeated.
    as_json
        Print JSON: of each format its folder.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.exporting import export_run

    export_run(run, format_, out, set_, as_json, quiet)


@app.command
def converge(
    case: CaseFile,
    *,
    seeds: int = 1,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    set_: Annotated[tuple[str, ...], Parameter(name=["--set", "-s"], negative="", consume_multiple=False)] = (),
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Solve a case on three meshes and tell its pressure drop with its error: convergence.json, a table, a plot.

    Tells the order of convergence, the limit for vanishing cells and an interval, and what the mesh, slip, the box and
    the seed each change. Finished runs are used again.

    Parameters
    ----------
    case
        The case file (TOML), or the name of a bundled case.
    seeds
        Mats of this many seeds are solved, on the case's mesh, to tell what chance changes.
    out
        Folder of the case's own run, which gets the result; ``runs/<name of the case file>`` if left out.
    set_
        Override a key of the case file: ``--set mat.seed=7``. May be repeated.
    as_json
        Print convergence.json instead of tables.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.converging import converge_case

    converge_case(found(case), out or Path("runs") / case.stem, seeds, set_, as_json, quiet)


@app.command
def permeability(
    case: Path,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    set_: Annotated[tuple[str, ...], Parameter(name=["--set", "-s"], negative="", consume_multiple=False)] = (),
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Solve the flow along x, y and z of a mat: permeability.json with the tensor, and a table.

    In its plane the mat is turned and solved as a case of its own; docs/structure.md tells what that leaves open.

    Parameters
    ----------
    case
        The case file (TOML), or the name of a bundled case.
    out
        Folder of the case's own run, which gets the result; ``runs/<name of the case file>`` if left out.
    set_
        Override a key of the case file: ``--set mat.seed=7``. May be repeated.
    as_json
        Print permeability.json instead of the table.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.permeating import permeability_of_case

    permeability_of_case(found(case), out or Path("runs") / case.stem, set_, as_json, quiet)


@app.command
def tiles(
    case: Path,
    *,
    tiles: str = "2x2",
    workers: int | None = None,
    scheduler: str | None = None,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    set_: Annotated[tuple[str, ...], Parameter(name=["--set", "-s"], negative="", consume_multiple=False)] = (),
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Mesh a case in tiles by several processes, and write it as a case of OpenFOAM that is decomposed already.

    No process ever holds more than one tile, and no file more than one. The tiles fit each other face by face, and each
    is judged with its neighbors beside it. The engine has to be the lattice.

    Parameters
    ----------
    case
        The case file (TOML), or the name of a bundled case.
    tiles
        How many along x and y.
    workers
        Processes of this machine, as many as it has cores if left out; or jobs of SLURM.
    scheduler
        Address of a running dask scheduler, like ``tcp://host:8786``, whose workers see the folder under the same path;
        or ``slurm``.
    out
        Folder of the run, which gets a folder ``tiles``; ``runs/<name of the case file>`` if left out.
    set_
        Override a key of the case file: ``--set tetmesh.edge=0.8``. May be repeated.
    as_json
        Print tiles.json instead of a table.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.tiling import tile_case

    tile_case(found(case), out or Path("runs") / case.stem, tiles, workers, scheduler, set_, as_json, quiet)


@app.command
def quality(
    mesh: Path,
    *,
    limits: Path | None = None,
    report: Path | None = None,
    html: Path | None = None,
    scene: Annotated[Path | None, Parameter(show=False)] = None,
    fail_on: Literal["warn", "fail"] = "warn",
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Judge any mesh by OpenFOAM's definitions, whoever made it.

    The exit code is 0 where every limit holds, 3 where what does not hold costs accuracy only, 4 where the mesh is not
    fit for a solver, 1 where it cannot be read, 2 where the command line is wrong.

    Parameters
    ----------
    mesh
        An OpenFOAM case's folder, a mesh file (Fluent's .msh and .cas in text, .vtu, .vtk, .vti, .vts, .vtr, gmsh's
        .msh, .inp, .bdf, .su2, .mesh), or the folder of a run.
    limits
        A case file whose limits (``[quality]``) are held against the mesh, instead of those of checkMesh.
    report
        Write a page of the mesh into this file (.html): verdict, table, histograms, pictures, worst cells, provenance.
    html
        Write the mesh into this file (.html) to turn and to cut it in a browser, offline too.
    fail_on
        With ``fail``, a verdict of ``warn`` ends with 0 as well.
    as_json
        Print JSON with SI numbers, with the worst cells and where they are, instead of a table.
    quiet
        Print nothing but errors: the exit code tells.
    """
    from pipeline.cli.judging import judge_mesh

    if scene is not None:
        raise CaseError("--scene names a view of fibertwin view; the file to turn in a browser is --html FILE")
    raise SystemExit(judge_mesh(mesh, found(limits) if limits else None, report, html, as_json, quiet, fail_on))


@app.command
def predict(
    source: Annotated[Path | None, Parameter(completer=completing.cases)] = None,
    *,
    from_: Annotated[
        tuple[Path, ...], Parameter(name="--from", negative="", consume_multiple=False, completer=completing.runs)
    ] = (),
    solidity: str | None = None,
    thickness: str | None = None,
    fiber_diameter: str | None = None,
    face_velocity: str | None = None,
    particle_diameter: str | None = None,
    particle_spread: str | None = None,
    temperature: str | None = None,
    preset: Annotated[str | None, Parameter(completer=completing.presets)] = None,
    pressure_model: Annotated[str | None, Parameter(completer=completing.pressure_models)] = None,
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    plot: Path | None = None,
) -> None:
    """Predict pressure drop and efficiency with the analytical models, without any mesh.

    Parameters
    ----------
    source
        A case file, whose mat is grown, or the folder of a run; options below change what it says.
    from_
        The folder of a solved run: a slab of a medium that is as thick as ``--thickness`` says. Its pressure drop is
        scaled, with an interval, and what passed it of particles too. May be repeated for slabs of other seeds.
    solidity
        Fiber volume over mat volume: ``9.5 %`` or 0.095.
    thickness
        Thickness of the mat: ``47 um``.
    fiber_diameter
        Diameter of the fibers: ``1.4 um``; or a distribution as a case file has it, from which that of equal fibers
        of the same length and volume is taken: ``{distribution="lognormal", median="1.2 um", geometric_std=1.5}``.
    face_velocity
        Flow rate over the face's area: ``2.5 cm/s``.
    particle_diameter
        Particle size at which efficiencies are told: ``300 nm``.
    particle_spread
        Geometric standard deviation of a lognormal aerosol: 1.6.
    temperature
        Of the air: ``20 degC``.
    preset
        Single-fiber model: paper, table_a6 or hinds.
    pressure_model
        Pressure-drop model that the figure of merit is made with.
    as_json
        Print JSON with SI numbers instead of tables.
    plot
        Draw efficiency, figure of merit and pressure drop into this file (svg, png or pdf).
    """
    from pipeline.cli.predicting import predict_filter, predict_thick

    texts = {
        "solidity": solidity,
        "thickness": thickness,
        "fiber_diameter": fiber_diameter,
        "face_velocity": face_velocity,
        "particle_diameter": particle_diameter,
        "particle_spread": particle_spread,
        "temperature": temperature,
        "preset": preset,
        "pressure_model": pressure_model,
    }
    given = {name: text for name, text in texts.items() if text is not None}
    if from_:
        if source is not None or plot is not None:
            raise CaseError("--from takes the place of a case, and draws nothing: leave the case and --plot out")
        predict_thick(from_, given, as_json)
        return
    predict_filter(found(source) if source else None, given, as_json, plot)


@app.command
def tune(
    case: CaseFile,
    *,
    target: Annotated[tuple[str, ...], Parameter(negative="", consume_multiple=False)] = (),
    seeds: int = 8,
    keep: Annotated[tuple[str, ...], Parameter(negative="", consume_multiple=False)] = (),
    set_: Annotated[tuple[str, ...], Parameter(name=["--set", "-s"], negative="", consume_multiple=False)] = (),
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Find the relaxation slope, spacing and coverage with which a layered mat has what was measured on a filter.

    Prints the keys for the case file, and what mats of these settings measure over several seeds.

    Parameters
    ----------
    case
        The case file (TOML), with a layered mat; its fiber diameter and its plan stay.
    target
        What was measured: ``--target solidity=0.08``, thickness, coverage, pressure_drop or efficiency. One or two.
    seeds
        How many mats every step looks at.
    keep
        Leave this key as the case has it: relaxation_slope or spacing. May be repeated.
    set_
        Override a key of the case file: ``--set mat.side="50 um"``. May be repeated.
    as_json
        Print JSON with SI numbers instead of TOML and a table.
    quiet
        Print the keys for the case file only.
    """
    from pipeline.cli.tuning import tune_case

    tune_case(found(case), target, set_, seeds, keep, as_json, quiet)


@app.command
def measure(
    image: Path,
    *,
    pixel: str | None = None,
    bar: str | None = None,
    window: str | None = None,
    case: Path | None = None,
    page: Path | None = None,
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Measure the fibers of a micrograph: diameters, directions, and the laws that a mat of them has.

    Beads, streaks, crossings and the strip below the picture do not count. docs/measuring.md tells how far to trust it.

    Parameters
    ----------
    image
        The picture, TIFF or PNG.
    pixel
        Length of a pixel: ``--pixel "25 nm"``; unless given, what the file says.
    bar
        Length that the bar in the picture's strip stands for, as "10 um", instead of the pixel's.
    window
        Part of the picture: left,top,right,bottom in pixels.
    case
        Write the case whose mat has these laws into this file (.toml).
    page
        Write the page, the picture with what was seen drawn over it, into this file (.html) instead of
        ``runs/<name of the picture>/micrograph.html``.
    as_json
        Print JSON with SI numbers instead of a table.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.measuring import measure_picture

    measure_picture(image, pixel, bar, window, page, case, as_json, quiet)


@app.command
def twin(
    measured: Path | None = None,
    *,
    micrograph: str | None = None,
    pixel: str | None = None,
    bar: str | None = None,
    fiber_diameter: str | None = None,
    fiber_density: Annotated[str | None, Parameter(name=["--fiber-density", "--density"])] = None,
    basis_weight: str | None = None,
    solidity: str | None = None,
    thickness: str | None = None,
    pressure_drop: str | None = None,
    face_velocity: str | None = None,
    temperature: str | None = None,
    pressure: str | None = None,
    pressure_model: str | None = None,
    side: str | None = None,
    contact: str | None = None,
    seeds: int | None = None,
    case: Path | None = None,
    solve: Annotated[bool, Parameter(negative="")] = False,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Find the case whose mat has what was measured on a filter, each within its tolerance, seed and all.

    A value takes its tolerance behind "+-", in its unit or as a share of it in percent; 5 % unless given. Fibers come
    from a micrograph or a diameter; of basis weight, solidity, thickness and pressure drop two or more. What cannot be
    matched is said, with the nearest; the exit code is then 3.

    Parameters
    ----------
    measured
        A file (TOML) with these options as keys, ``thickness = "60 um +- 5 %"``; options change what it says.
    micrograph
        Picture of the fibers (TIFF, PNG), or the file with what ``fibertwin measure --json`` told of one.
    pixel
        Length of the picture's pixel: ``--pixel "25 nm"``; unless given, what its file says.
    bar
        Length that the bar in the picture's strip stands for, instead of the pixel's.
    fiber_diameter
        Where there is no picture: ``"1.4 um +- 3 %"``, or a distribution as a case file has it.
    fiber_density
        Of what the fibers are made of, for the basis weight: ``"2500 kg/m^3"``.
    basis_weight
        Mass over area: ``"8 g/m^2 +- 3 %"``.
    solidity
        Fiber volume over the medium's: ``"8 % +- 5 %"``, whose tolerance is 0.4 points.
    thickness
        ``"60 um +- 3 um"``.
    pressure_drop
        ``"45 Pa at 5.3 cm/s +- 10 %"``, the face velocity with it.
    face_velocity
        Of the pressure drop, where that does not tell.
    temperature
        Of the air: ``"20 degC"``.
    pressure
        Of the air: ``"1 atm"``.
    pressure_model
        Model of the pressure drop; davies unless given.
    side
        Edge of the twin's plan; 30 mean diameters unless given.
    contact
        clear (fibers do not overlap; unless given) or paper (they do a little, and lie tighter).
    seeds
        Mats that every step looks at: 8 unless given.
    case
        Write the case into this file (.toml) instead of printing it.
    solve
        Solve the flow, and aim again until the solved pressure drop is within its tolerance: minutes.
    out
        Folder of the run that is solved; ``runs/<name of the case>`` if left out.
    as_json
        Print JSON with SI numbers instead of a table.
    quiet
        Print nothing but errors, and the case if it has no file.
    """
    from pipeline.cli.twinning import find_twin

    texts = {
        "micrograph": micrograph,
        "pixel": pixel,
        "bar": bar,
        "fiber_diameter": fiber_diameter,
        "fiber_density": fiber_density,
        "basis_weight": basis_weight,
        "solidity": solidity,
        "thickness": thickness,
        "pressure_drop": pressure_drop,
        "face_velocity": face_velocity,
        "temperature": temperature,
        "pressure": pressure,
        "pressure_model": pressure_model,
        "side": side,
        "contact": contact,
        "seeds": None if seeds is None else str(seeds),
    }
    given = {name: text for name, text in texts.items() if text is not None}
    raise SystemExit(find_twin(found(measured) if measured else None, given, case, solve, out, as_json, quiet))


@app.command
def micrograph(
    source: CaseFile,
    into: Path,
    *,
    pixel: str | None = None,
    depth: str | None = None,
    edge: float = 1.0,
    blur: float = 1.0,
    noise: float = 0.05,
    seed: int = 0,
) -> None:
    """Take the picture of a mat from above as a scanning electron microscope would, to hold it beside a real one.

    Parameters
    ----------
    source
        A case file, whose mat is grown, or the folder of a run.
    into
        The picture to write (.png).
    pixel
        Length of a pixel; a twentieth of the mean diameter unless given.
    depth
        Depth over which brightness falls by a factor of e; three mean diameters unless given.
    edge
        By how much rims are brighter than the middle of a fiber, as a share of it.
    blur
        Standard deviation of the beam's width, in pixels.
    noise
        Standard deviation of each pixel, as a share of the brightness of the top.
    seed
        Of the noise.
    """
    from pipeline.cli.measuring import take_picture

    take_picture(found(source), into, pixel, depth, edge, blur, noise, seed)


@app.command
def tomography(
    stack: Path,
    *,
    voxel: str,
    window: str | None = None,
    shape: str | None = None,
    kind: str = "uint8",
    threshold: str = "otsu",
    smallest: int = 0,
    dark: Annotated[bool, Parameter(negative="")] = False,
    surface: Path | None = None,
    case: Path | None = None,
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Make the surface of a tomogram's solid, of the voxels' own volume, and the case that it is the medium of.

    Parameters
    ----------
    stack
        A folder of TIFFs, one per slice; a TIFF of many pages; .npy (slices first); or .raw. Slices are planes across
        the flow.
    voxel
        Edge of a voxel: ``--voxel "0.7 um"``.
    window
        Voxels to take: x0,y0,z0,x1,y1,z1. Only these are read.
    shape
        Of a .raw file: x,y,z, whose x runs fastest.
    kind
        Numbers of a .raw file: uint8, <u2, >u2 or float32.
    threshold
        Gray value from which on a voxel is solid, or otsu.
    smallest
        Islands and closed pores of fewer voxels than this are left out.
    dark
        The solid is darker than the air.
    surface
        Write the surface into this file (.vtp, .ply or .stl, in um) instead of ``runs/<name>/surface.vtp``.
    case
        Write the case of this medium into this file (.toml).
    as_json
        Print JSON with SI numbers instead of words.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.listen import listening
    from pipeline.cli.tomograms import surface_of_tomogram

    with listening(err, quiet or as_json) as progress:
        surface_of_tomogram(
            stack, voxel, window, shape, kind, threshold, smallest, dark, surface, case, as_json, quiet, progress
        )


@app.command
def study(
    study: Annotated[Path, Parameter(completer=completing.studies)],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    plot: Path | None = None,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Run a case many times, with keys swept and seeds repeated, and tell means with 95 % confidence intervals.

    Finished runs are kept: the same command continues a study that was stopped, and tries failed runs again.

    Parameters
    ----------
    study
        The study file (TOML); docs/studies.md describes it.
    workers
        Processes of this machine, as many as it has cores unless given; or jobs of SLURM.
    scheduler
        Address of a running dask scheduler, whose workers see the folder under the same path; or ``slurm``.
    out
        Folder of the study; ``runs/studies/<name of the study file>`` if left out.
    plot
        Draw the plot into this file (svg, png or pdf) instead of ``plot.svg`` in the folder.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.studying import run_study

    run_study(found(study), out or Path("runs/studies") / study.stem, workers, scheduler, plot, quiet)


@app.command
def report(
    *runs: RunFolder,
    pdf: Annotated[bool, Parameter(negative="")] = False,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    as_json: Annotated[bool, Parameter(name="--json", negative="")] = False,
    quiet: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Write report.html of a run: the number, whether to trust it, what was made; or of several runs side by side.

    The page holds its pictures and asks nothing of the network. A run writes it at its end; this writes it again, or
    for a run that stopped half way.

    Parameters
    ----------
    runs
        The folder of a run, whole or partial; of two to six for a page that compares them with the first.
    pdf
        Print the page as PDF too, by Chromium, Chrome or Edge, beside it.
    out
        Write the page into this file (.html): a copy of a run's, or that of several, which is ``compared.html`` unless
        named.
    as_json
        Print all that the page shows as JSON with SI numbers; for one run ``RUN/report/page.json`` has it too.
    quiet
        Print nothing but errors.
    """
    from pipeline.cli.viewing import write_pages

    if not runs:
        raise CaseError("report of which run? fibertwin report RUN, or several: fibertwin report A B")
    write_pages(runs, out, pdf, as_json, quiet)


@app.command
def view(
    run: RunFolder,
    *,
    scene: Annotated[str | None, Parameter(completer=completing.scenes)] = None,
    screenshot: Path | None = None,
    html: Path | None = None,
) -> None:
    """Look at a run's geometry and mesh in a window; without a screen, draw every view into RUN/pictures.

    Parameters
    ----------
    run
        The folder of a run, whole or partial.
    scene
        One view by its name: mat-top, mat-side, duct, cut, close-up, cells, mesh-fibers, flow, flow-slice or worst.
    screenshot
        Draw the view (duct unless another is named) into this file, png or jpg, instead of opening a window.
    html
        Write geometry, mesh, flow and caught particles into this file (.html) to turn and to cut them in a browser,
        offline too, instead.
    """
    from pipeline.cli.viewing import view_run, write_model_of_run

    if html is not None:
        write_model_of_run(run, html)
    if html is None or screenshot is not None:
        view_run(run, scene, screenshot)


@app.command
def init(
    file: Path = Path("case.toml"),
    *,
    generator: Annotated[str, Parameter(completer=completing.generators)] = "layered",
) -> None:
    """Write a case file with every key, its meaning and its default, to fill in; never over a file that is there.

    Parameters
    ----------
    file
        The case file to write.
    generator
        Where the fibers come from: layered (dropped one after the other), box (straight, anywhere in a slab), array
        (parallel), file (your own, from CSV) or surface (a medium by its own surface).
    """
    from pipeline.cli.starting import write_first_case

    write_first_case(file, generator)
    out.print(f"{file} is written; next: fibertwin run {file}", markup=False, highlight=False, soft_wrap=True)


@app.command
def cases() -> None:
    """List the bundled cases: each runs by its name alone, as in ``fibertwin run smoke``."""
    from pipeline.cli.bundled import bundled, story
    from pipeline.cli.tables import story_table

    out.print(story_table((name, story(path)) for name, path in bundled().items()))


@app.command
def schema(*, markdown: Annotated[bool, Parameter(negative="")] = False) -> None:
    """Print the JSON Schema of the case file, for editors and other programs.

    Parameters
    ----------
    markdown
        Print the reference of every key as a page instead.
    """
    if markdown:
        from pipeline.cli.reference import case_file_reference

        sys.stdout.write(case_file_reference())
        return
    from pipeline.case import Case

    sys.stdout.write(json.dumps(Case.model_json_schema(), indent=2) + "\n")


@app.command
def doctor() -> None:
    """Say what is installed, in which version, and what is missing; exit code 1 if anything needed is."""
    from pipeline.cli.doctor import examine
    from pipeline.cli.tables import findings_table

    findings = examine()
    # a console of its own: as wide as the terminal is now
    Console().print(findings_table(findings))
    if not all(finding.fine for finding in findings if finding.needed):
        raise SystemExit(1)


def _refuse_odd_names(words: list[str]) -> None:
    """Refuse names that are no text, which neither VTK nor a page nor JSON can take, before anything is made."""
    try:
        here = os.getcwd()  # noqa: PTH109 (its text, not its path)
    except FileNotFoundError:
        raise CaseError("the current folder has been removed; change to another") from None
    for word in (*words, here):
        if not is_text(word):
            raise CaseError(f"{word!r} is no text in UTF-8: rename it, or choose another folder")


def main() -> None:
    """Run the command line: a user's mistake becomes one message and an exit code, a bug keeps its traceback."""
    try:
        _refuse_odd_names(sys.argv[1:])
        app(sys.argv[1:], exit_on_error=False, print_error=False)
        # or the interpreter would find at its very end that the disk is full
        sys.stdout.flush()
    except CycloptsError as problem:
        err.print(f"error: {problem}; see fibertwin --help", style="red", markup=False, highlight=False, soft_wrap=True)
        raise SystemExit(WRONG_USE) from None
    except FibertwinError as problem:
        err.print(f"error: {printable(str(problem))}", style="red", markup=False, highlight=False, soft_wrap=True)
        raise SystemExit(problem.exit_code) from None
