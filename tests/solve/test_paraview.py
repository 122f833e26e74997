"""What a solved run hands to ParaView: a script that asks for nothing that ParaView does not have."""

# SPDX-License-Identifier: GPL-3.0-or-later

import ast
import runpy
import sys
import types
from pathlib import Path
from typing import Any

import pytest
import pyvista as pv

from pipeline.solve.paraview import SCRIPT, write_paraview

DOCUMENTED = {
    "GetActiveViewOrCreate": {"CameraPosition", "CameraFocalPoint", "CameraViewUp", "ViewSize"},
    "GetColorTransferFunction": set(),
    "GetScalarBar": {"Title", "ComponentTitle"},
    "XMLUnstructuredGridReader": {"FileName"},
    "XMLPolyDataReader": {"FileName"},
    "Slice": {"Input", "SliceType"},
    "Plane": {"Origin", "Point1", "Point2", "XResolution", "YResolution", "Normal"},
    "StreamTracerWithCustomSource": {
        "Input", "SeedSource", "Vectors", "IntegrationDirection", "MaximumStreamlineLength",
    },
    "Tube": {"Input", "Radius"},
    "Show": {"AmbientColor", "DiffuseColor"},
    "SaveScreenshot": {"ImageResolution"},
}  # fmt: skip
"""Properties by what has them, from the reference of paraview.simple 5.9 to 5.13; 5.11 has run the script."""


class Proxy:
    """Stands for something of ParaView's, and has only the properties that its reference names."""

    kind: str
    calls: list[str]
    FileName: list[str]

    def __init__(self, kind: str, given: dict[str, Any]) -> None:
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "calls", [])
        for name, value in given.items():
            setattr(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        assert name in DOCUMENTED[self.kind], f"{self.kind} has no {name}"
        made = Proxy("Plane", {}) if name == "SliceType" else value
        object.__setattr__(self, name, made)

    def UpdatePipeline(self) -> None:  # noqa: N802
        self.calls.append("UpdatePipeline")

    def GetDataInformation(self) -> "Proxy":  # noqa: N802
        assert "UpdatePipeline" in self.calls
        return self

    def GetBounds(self) -> tuple[float, ...]:  # noqa: N802
        return tuple(pv.read(self.FileName[0]).bounds)

    def RescaleTransferFunctionToDataRange(self, extend: bool) -> None:  # noqa: N802
        self.calls.append("rescaled")

    def SetScalarBarVisibility(self, view: "Proxy", visible: bool) -> None:  # noqa: N802
        assert view.kind == "GetActiveViewOrCreate"


def folder_of_a_run(run: Path, exported: bool) -> Path:
    solve, boundary = run / "solve", run / "export" / "vtk" / "boundary"
    solve.mkdir(parents=True)
    box = pv.ImageData(dimensions=(3, 3, 5), spacing=(1e-6, 1e-6, 2e-6)).cast_to_unstructured_grid()
    box.save(solve / "flow.vtu")
    if exported:
        boundary.mkdir(parents=True)
        for name in ("inlet", "fibers"):
            pv.Sphere().save(boundary / f"{name}.vtp")
    write_paraview(solve)
    return solve


@pytest.mark.parametrize("exported", [True, False])
def test_the_script_asks_only_for_what_paraview_documents(
    exported: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Proxy] = []
    colored: list[tuple[str, ...] | None] = []
    saved: list[str] = []

    def maker(kind: str) -> Any:
        def make(*shown: Any, **given: Any) -> Proxy:
            made.append(Proxy(kind, given))
            return made[-1]

        return make

    simple = types.ModuleType("paraview.simple")
    for kind in DOCUMENTED.keys() - {"SaveScreenshot"}:
        setattr(simple, kind, maker(kind))
    simple.LoadPalette = lambda name: None  # type: ignore[attr-defined]
    simple.ColorBy = lambda shown, by: colored.append(by)  # type: ignore[attr-defined]
    simple.Render = simple.ResetCamera = lambda view: None  # type: ignore[attr-defined]
    simple.SaveScreenshot = lambda name, view, ImageResolution: saved.append(name)  # type: ignore[attr-defined]  # noqa: N803
    monkeypatch.setitem(sys.modules, "paraview", types.ModuleType("paraview"))
    monkeypatch.setitem(sys.modules, "paraview.simple", simple)
    script = folder_of_a_run(tmp_path, exported) / SCRIPT
    monkeypatch.setattr(sys, "argv", [str(script), "flow.png"])
    runpy.run_path(str(script))
    # speed and pressure on planes, and the streamlines by their speed; the fibers by nothing
    by_speed, by_pressure = ("POINTS", "velocity", "Magnitude"), ("POINTS", "pressure")
    assert colored == [by_speed, by_pressure, by_speed, *([None] if exported else [])]
    assert saved == ["flow.png"]
    assert any(proxy.kind == "XMLPolyDataReader" for proxy in made) == exported
    seeds = [proxy for proxy in made if proxy.kind == "Plane"]
    # within the duct of 2 by 2 by 8 um
    assert all(0.0 < at < 8e-6 for at in (*seeds[-1].Origin, *seeds[-1].Point1, *seeds[-1].Point2))  # type: ignore[attr-defined]


def test_the_script_is_python_of_older_paraviews_too(tmp_path: Path) -> None:
    write_paraview(tmp_path)
    # ParaView 5.9 came with Python 3.8
    ast.parse((tmp_path / SCRIPT).read_text(encoding="utf-8"), feature_version=(3, 8))
