"""VTK files for ParaView and PyVista: the volume, one surface per patch, and one file that names them all."""

from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from pipeline.data import FaceMesh, Floats, Patch
from pipeline.geometry.faces import compacted
from pipeline.progress import Progress, silent

VOLUME = "internal.vtu"


def write_vtk(mesh: FaceMesh, folder: Path, fields: Mapping[str, Floats], progress: Progress = silent) -> None:
    """Write `mesh.vtm`, which names `internal.vtu` and `boundary/<patch>.vtp`.

    Parameters
    ----------
    mesh : FaceMesh
        Of tetrahedra.
    folder : Path
        Made if it is not there.
    fields : mapping of name to (cells,) array
        Put on the cells, for example the quality of each.
    progress : Progress

    Raises
    ------
    ValueError
        If a cell is no tetrahedron.
    """
    import pyvista as pv

    progress("export: VTK")
    triangles = mesh.triangles()
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: mesh.tets()}, np.array(mesh.points))
    (folder / "boundary").mkdir(parents=True, exist_ok=True)
    for name, values in fields.items():
        grid.cell_data[name] = values
    grid.save(folder / VOLUME)
    for patch in mesh.patches:
        points, faces = compacted(mesh.points, triangles[patch.start : patch.start + patch.count])
        surface = pv.PolyData.from_regular_faces(points, faces)
        surface.cell_data["owner"] = mesh.owner[patch.start : patch.start + patch.count]
        surface.save(folder / "boundary" / f"{patch.name}.vtp")
    (folder / "mesh.vtm").write_text(format_vtm(mesh.patches), encoding="utf-8")


def format_vtm(patches: tuple[Patch, ...]) -> str:
    """Index of the files, in the layout of OpenFOAM's `foamToVTK`: `internal`, and `boundary` with a block per patch.

    Examples
    --------
    >>> print(format_vtm((Patch("inlet", 0, 1),)))
    <?xml version="1.0"?>
    <VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">
      <vtkMultiBlockDataSet>
        <DataSet index="0" name="internal" file="internal.vtu"/>
        <Block index="1" name="boundary">
          <DataSet index="0" name="inlet" file="boundary/inlet.vtp"/>
        </Block>
      </vtkMultiBlockDataSet>
    </VTKFile>
    <BLANKLINE>
    """
    blocks = "".join(
        f"      <DataSet index={quoteattr(str(k))} name={quoteattr(patch.name)} "
        f"file={quoteattr(f'boundary/{patch.name}.vtp')}/>\n"
        for k, patch in enumerate(patches)
    )
    return (
        '<?xml version="1.0"?>\n'
        '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">\n'
        "  <vtkMultiBlockDataSet>\n"
        f'    <DataSet index="0" name="internal" file="{VOLUME}"/>\n'
        f'    <Block index="1" name="boundary">\n{blocks}    </Block>\n'
        "  </vtkMultiBlockDataSet>\n</VTKFile>\n"
    )
