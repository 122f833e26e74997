"""A script that opens a solved run in ParaView: the flow on planes and along streamlines, and the fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

SCRIPT = "open_in_paraview.py"


def write_paraview(folder: Path) -> None:
    """Write the script beside ``flow.vtu``; it finds what else the run has when it is opened."""
    (folder / SCRIPT).write_text(_SCRIPT, encoding="utf-8")


_SCRIPT = '''"""Open a solved run in ParaView: speed and pressure on planes along the flow, streamlines, and the fibers.

    paraview --script=solve/open_in_paraview.py
    pvpython solve/open_in_paraview.py flow.png
"""

import os
import sys

from paraview.simple import (
    ColorBy, GetActiveViewOrCreate, GetColorTransferFunction, GetScalarBar, LoadPalette, Plane, Render, ResetCamera,
    SaveScreenshot, Show, Slice, StreamTracerWithCustomSource, Tube, XMLPolyDataReader, XMLUnstructuredGridReader,
)

# ParaView itself does not say where a script lies when it is pasted into its shell
here = os.path.dirname(os.path.abspath(globals().get("__file__", os.path.join("solve", "open_in_paraview.py"))))
SEEDS = 8  # streamlines along each side of the inlet

LoadPalette("WhiteBackground")
view = GetActiveViewOrCreate("RenderView")
view.ViewSize = [1200, 900]
flow = XMLUnstructuredGridReader(FileName=[os.path.join(here, "flow.vtu")])
flow.UpdatePipeline()
x0, x1, y0, y1, z0, z1 = flow.GetDataInformation().GetBounds()
middle = [0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (z0 + z1)]


def plane(normal):
    cut = Slice(Input=flow, SliceType="Plane")
    cut.SliceType.Origin = middle
    cut.SliceType.Normal = normal
    return cut


def colored(source, *by):
    shown = Show(source, view)
    ColorBy(shown, ("POINTS",) + by)
    shown.RescaleTransferFunctionToDataRange(True)
    shown.SetScalarBarVisibility(view, True)
    bar = GetScalarBar(GetColorTransferFunction(by[0]), view)
    bar.Title = {"velocity": "speed [m/s]", "pressure": "pressure [Pa]"}[by[0]]
    bar.ComponentTitle = ""


colored(plane([1.0, 0.0, 0.0]), "velocity", "Magnitude")
colored(plane([0.0, 1.0, 0.0]), "pressure")

# a little behind the inlet, and off the sides
gap = 0.01 * (z1 - z0)
inset = 0.02 * (x1 - x0)
seeds = Plane(
    Origin=[x0 + inset, y0 + inset, z0 + gap],
    Point1=[x1 - inset, y0 + inset, z0 + gap],
    Point2=[x0 + inset, y1 - inset, z0 + gap],
    XResolution=SEEDS,
    YResolution=SEEDS,
)
lines = StreamTracerWithCustomSource(Input=flow, SeedSource=seeds)
lines.Vectors = ["POINTS", "velocity"]
lines.IntegrationDirection = "FORWARD"
lines.MaximumStreamlineLength = 4.0 * (z1 - z0)
tubes = Tube(Input=lines)
tubes.Radius = 0.002 * (z1 - z0)
colored(tubes, "velocity", "Magnitude")

fibers = os.path.join(here, "..", "export", "vtk", "boundary", "fibers.vtp")
if os.path.exists(fibers):
    shown = Show(XMLPolyDataReader(FileName=[fibers]), view)
    # not by a field of its own, as ParaView would
    ColorBy(shown, None)
    shown.AmbientColor = shown.DiffuseColor = [0.75, 0.75, 0.7]

view.CameraPosition = [middle[0] + 2.5 * (z1 - z0), middle[1] + 1.5 * (z1 - z0), middle[2] + 0.5 * (z1 - z0)]
view.CameraFocalPoint = middle
view.CameraViewUp = [0.0, 0.0, 1.0]
ResetCamera(view)
Render(view)
if len(sys.argv) > 1 and sys.argv[1].endswith(".png"):
    SaveScreenshot(sys.argv[1], view, ImageResolution=[1600, 1200])
'''
