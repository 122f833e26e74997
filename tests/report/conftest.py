"""Whether this machine can do what pictures and pages need; asked without any of our own code."""

# SPDX-License-Identifier: GPL-3.0-or-later

import subprocess
import sys

import pytest

from pipeline.report.views.render import rendering_environment

_SPHERE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True)
plotter.add_mesh(pyvista.Sphere())
assert plotter.screenshot(None, return_img=True).std() > 0
"""


@pytest.fixture(scope="session")
def rendering() -> None:
    """Skip where VTK cannot even draw a sphere."""
    command = [sys.executable, "-P", "-c", _SPHERE]
    if subprocess.run(command, env=rendering_environment(), capture_output=True, check=False).returncode:
        pytest.skip("VTK finds no OpenGL here")
