"""Formats that people ask for and do not get, each with the reason and what to take instead."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.export.formats.format import Format

_HDF5 = "needs HDF5, which is not installed with fibertwin; take gmsh"
_LOST = "would lose the patches; take openfoam, vtk or gmsh"
_OTHER_FILES = "names other files, which a mesh file may not; take the .vtu that it names"

UNAVAILABLE = (
    Format("off", (".off",), cells="none", unavailable_because="holds a surface, not a volume; take stl, ply or obj"),
    Format("tetgen", (".ele", ".node"), unavailable_because=_LOST),
    Format("xdmf", (".xdmf", ".xmf"), unavailable_because=_LOST),
    Format("vtu", unavailable_because="is a part of vtk; take vtk, which keeps the patches"),
    Format("tecplot", (".tec",), unavailable_because=_LOST),
    Format("ugrid", (".ugrid",), unavailable_because=_LOST),
    Format("med", (".med",), unavailable_because=_HDF5),
    Format("cgns", (".cgns",), unavailable_because=_HDF5),
    Format("exodus", (".e", ".exo"), unavailable_because=_HDF5),
    Format("h5m", (".h5m",), unavailable_because=_HDF5),
    Format("vtkhdf", (".vtkhdf",), unavailable_because="needs HDF5; save a .vtu"),
    Format("fluent-hdf5", (".h5",), unavailable_because="needs HDF5; write Fluent's mesh as text (.msh)"),
    Format("vtm", (".vtm", ".vtmb", ".pvtu", ".pvd"), unavailable_because=_OTHER_FILES),
    Format("meshb", (".meshb",), unavailable_because="is binary; write Medit's mesh as text (.mesh)"),
)
