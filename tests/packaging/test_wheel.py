"""The wheel holds what a user needs, and works where no checkout is. Needs the package index, so it is slow."""

# SPDX-License-Identifier: GPL-3.0-or-later

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run([sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", folder, ROOT], check=True)
    return next(folder.glob("fibertwin-*.whl"))


def test_the_wheel_holds_cases_types_templates_and_the_license(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    cases = {path.relative_to(ROOT / "cases").as_posix() for path in (ROOT / "cases").rglob("*.toml")}
    assert {f"pipeline/bundled_cases/{name}" for name in cases} <= names
    assert {"pipeline/py.typed", "pipeline/report/templates/report.html.jinja"} <= names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert not any(name.startswith(("tests/", "docs/")) for name in names)


def test_a_clean_environment_runs_a_bundled_case_outside_the_checkout(wheel: Path, tmp_path: Path) -> None:
    environment = tmp_path / "clean"
    subprocess.run([sys.executable, "-m", "venv", environment], check=True)
    constraints = ROOT / "constraints.txt"
    pip: list[str | Path] = [environment / "bin/python", "-m", "pip", "install", "--quiet"]
    subprocess.run([*pip, "--constraint", constraints, wheel], check=True)
    subprocess.run([environment / "bin/fibertwin", "run", "smoke", "--until", "surface"], cwd=tmp_path, check=True)
    assert (tmp_path / "runs/smoke/surface/surface.stl").is_file()
