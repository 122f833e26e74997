"""A complete simpleFoam case: the mesh, the fields at the start, the solver's dictionaries, and scripts."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.errors import StageError
from pipeline.export.formats.openfoam import dictionaries as foam
from pipeline.export.formats.openfoam.cyclic import with_matching_sides
from pipeline.export.formats.openfoam.poly_mesh import write_poly_mesh
from pipeline.export.formats.openfoam.slip import FiberSlip
from pipeline.export.settings import ExportSettings
from pipeline.nouns.flow import Flow
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.nouns.patches import BY_NAME, FIBERS, INLET, OUTLET, SIDES
from pipeline.openfoam.decompose import format_decompose
from pipeline.openfoam.foam_file import format_labels
from pipeline.progress import Progress, silent

FIBER = "fiber"
"""Field in `0/` whose values on the wall number the fiber at each face."""


def write_openfoam(
    mesh: FaceMesh,
    folder: Path,
    flow: Flow,
    sides: str = "symmetry",
    settings: ExportSettings | None = None,
    progress: Progress = silent,
    slip: FiberSlip | None = None,
) -> None:
    """Write a case that `checkMesh`, `simpleFoam` and `./Allrun` take as it is.

    Parameters
    ----------
    mesh : FaceMesh
        With the patches `inlet` and `outlet`, any of the four sides, and `fibers`.
    folder : Path
        Made if it is not there.
    flow : Flow
    sides : "symmetry", "slip" or "cyclic"
        What the sides are to the solver.
    settings : ExportSettings
    progress : Progress
    slip : FiberSlip, optional
        How far the air slips along the fibers; it stands still on them without.

    Raises
    ------
    StageError
        If a patch is missing, empty or unknown, or the sides are cyclic but do not fit each other.
    """
    settings = settings or ExportSettings()
    _refuse_odd_patches(mesh)
    if sides == "cyclic":
        mesh = with_matching_sides(mesh)
    progress("export: OpenFOAM")
    for part in ("0", "constant/polyMesh", "system"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    types = {patch.name: _patch_type(mesh, patch, sides) for patch in mesh.patches}
    write_poly_mesh(mesh, folder / "constant/polyMesh", types, settings.encoding)
    _write_fields(mesh, folder / "0", types, flow, slip, with_fibers=len(mesh.fiber) > 0)
    _write_dictionaries(folder, flow, sides, settings, format_decompose(2))
    _write_script(folder / "Allrun", foam.format_allrun(flow, settings.dialect))
    _write_script(folder / "Allclean", foam.ALLCLEAN)


def write_processor(
    mesh: FaceMesh,
    folder: Path,
    number: int,
    neighbors: tuple[int, ...],
    flow: Flow,
    sides: str,
    settings: ExportSettings,
    slip: FiberSlip | None = None,
) -> None:
    """Write one tile of a mesh as OpenFOAM's `decomposePar` leaves what one process has.

    Parameters
    ----------
    mesh : FaceMesh
        With all patches of the duct, its planes exactly flat, and then one toward each neighbor.
    folder : Path
        Of the whole case, made if it is not there: the tile goes into its `processorN`.
    number : int
        Of the tile, from 0.
    neighbors : tuple of int
        The tiles that it borders on, in the order of their patches.
    flow : Flow
    sides : "symmetry" or "slip"
        What the sides are to the solver.
    settings : ExportSettings
    slip : FiberSlip, optional
        How far the air slips along the fibers; it stands still on them without.
    """
    place = folder / f"processor{number}"
    for part in ("0", "constant/polyMesh"):
        (place / part).mkdir(parents=True, exist_ok=True)
    plane = "type symmetryPlane;" if sides == "symmetry" else "type patch;"
    types = {
        patch.name: "type wall;" if patch.name == FIBERS else plane if patch.name in SIDES else "type patch;"
        for patch in mesh.patches
    }
    for patch, other in zip(mesh.patches[-len(neighbors) :] if neighbors else (), neighbors, strict=True):
        types[patch.name] = (
            "type processor; inGroups 1(processor); matchTolerance 0.0001; transform unknown; "
            f"myProcNo {number}; neighbProcNo {other};"
        )
    write_poly_mesh(mesh, place / "constant/polyMesh", types, settings.encoding)
    _write_fields(mesh, place / "0", types, flow, slip, with_fibers=True)


def write_around_processors(folder: Path, tiles: int, flow: Flow, sides: str, settings: ExportSettings) -> None:
    """Write what the processes of a decomposed case share: dictionaries and scripts.

    Parameters
    ----------
    folder : Path
    tiles : int
        Number of processes.
    flow : Flow
    sides : "symmetry" or "slip"
    settings : ExportSettings
    """
    for part in ("constant", "system"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    # it says how many there are; nobody asks how they came about
    _write_dictionaries(folder, flow, sides, settings, format_decompose(tiles))
    _write_script(folder / "Allrun", foam.format_allrun_in_tiles(flow, tiles, settings.dialect))
    _write_script(folder / "Allclean", foam.ALLCLEAN_IN_TILES)


def _write_fields(
    mesh: FaceMesh, place: Path, types: dict[str, str], flow: Flow, slip: FiberSlip | None, with_fibers: bool
) -> None:
    _write(place / "U", _velocity(types, flow, slip.condition(mesh) if slip else "type noSlip;"))
    _write(place / "p", _pressure(types))
    if with_fibers:
        _write(place / FIBER, _fibers(types, mesh))


def _write_dictionaries(folder: Path, flow: Flow, sides: str, settings: ExportSettings, decomposition: str) -> None:
    for name, text in foam.format_constant(flow, settings.dialect).items():
        _write(folder / "constant" / name, text)
    _write(folder / "system/controlDict", foam.format_control_dict(flow, settings.dialect))
    _write(folder / "system/fvSchemes", foam.format_fv_schemes(cyclic=sides == "cyclic"))
    _write(folder / "system/fvSolution", foam.format_fv_solution())
    _write(folder / "system/decomposeParDict", decomposition)
    _write(folder / "case.foam", "")


def _write_script(path: Path, text: str) -> None:
    _write(path, text)
    path.chmod(0o755)


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="ascii")


def _refuse_odd_patches(mesh: FaceMesh) -> None:
    counts = {patch.name: patch.count for patch in mesh.patches}
    missing = [name for name in (INLET, OUTLET) if not counts.get(name)]
    if missing:
        raise StageError(
            f"the mesh has no face in patch {' and '.join(missing)}: no air gets through; "
            "lengthen enclosure.inlet and enclosure.outlet"
        )
    unknown = sorted(set(counts) - set(BY_NAME))
    if unknown:
        raise StageError(f"no boundary condition is known for patch {', '.join(unknown)}")


def _patch_type(mesh: FaceMesh, patch: Patch, sides: str) -> str:
    if patch.name == FIBERS:
        return "type wall;"
    if patch.name in SIDES and sides == "symmetry":
        return "type symmetryPlane;" if _is_exact_plane(mesh, patch) else "type symmetry;"
    if patch.name in SIDES and sides == "cyclic":
        # entries about the transformation differ between OpenFOAM's dialects, and none is needed
        return f"type cyclic; neighbourPatch {BY_NAME[patch.name].opposite.name};"
    return "type patch;"


def _is_exact_plane(mesh: FaceMesh, patch: Patch) -> bool:
    """Whether one coordinate is the same to the last bit: OpenFOAM stops at a tilt of 3e-8."""
    corners = mesh.corners[mesh.offsets[patch.start] : mesh.offsets[patch.start + patch.count]]
    axis = BY_NAME[patch.name].axis
    return len(set(mesh.points[corners, axis].tolist())) == 1


def _velocity(types: dict[str, str], flow: Flow, on_fibers: str) -> str:
    through = f"(0 0 {flow.face_velocity!r})"
    conditions = {
        name: {
            INLET: f"type fixedValue; value uniform {through};",
            OUTLET: "type zeroGradient;",
            FIBERS: on_fibers,
        }.get(name, _side_condition(kind, "type slip;"))
        for name, kind in types.items()
    }
    return foam.format_field("U", "volVectorField", "[0 1 -1 0 0 0 0]", through, conditions)


def _fibers(types: dict[str, str], mesh: FaceMesh) -> str:
    # no solver reads it; ParaView shows it, and decomposePar cuts it with the mesh
    numbers = format_labels(mesh.fiber, "ascii").decode().strip()
    conditions = {
        name: f"type calculated; value nonuniform List<scalar> {numbers};"
        if name == FIBERS
        else _side_condition(kind, "type calculated; value uniform -1;")
        for name, kind in types.items()
    }
    return foam.format_field(FIBER, "volScalarField", "[0 0 0 0 0 0 0]", "-1", conditions)


def _pressure(types: dict[str, str]) -> str:
    conditions = {
        name: {
            INLET: "type zeroGradient;",
            OUTLET: "type fixedValue; value uniform 0;",
            FIBERS: "type zeroGradient;",
        }.get(name, _side_condition(kind, "type zeroGradient;"))
        for name, kind in types.items()
    }
    return foam.format_field("p", "volScalarField", "[0 2 -2 0 0 0 0]", "0", conditions)


def _side_condition(kind: str, otherwise: str) -> str:
    # a side of a constraint type takes the condition of the same name
    return otherwise if kind == "type patch;" else kind.split(";")[0] + ";"
