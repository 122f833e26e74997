"""What CONTRIBUTING.md says of adding something, followed line by line in a copy of the package."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LICENSE = "# SPDX-License-Identifier: GPL-3.0-or-later\n"
CASE = """
[mat]
generator = "layered"
side = "10 um"
fiber_diameter = "1.4 um"
relaxation_slope = 0.15
seed = 3
[mat.stop]
count = 3
"""


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    for name in ("pipeline", "cases"):
        # with what numba compiled, which takes a minute to make and holds for files of the same time and size
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("*.pyc", "sources-*.json"))
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


def added(folder: Path, name: str, content: str) -> None:
    path = folder / "pipeline" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'"""A toy."""\n\n{LICENSE}\n{content}')


def registered(folder: Path, name: str, before: str, line: str) -> None:
    path = folder / "pipeline" / name
    text = path.read_text()
    assert text.count(before) == 1, (name, before)
    path.write_text(text.replace(before, f"{line}{before}"))


def fibertwin(folder: Path, *words: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-m", "pipeline.cli", *words], cwd=folder, capture_output=True, text=True, check=False,
        env={"PYTHONPATH": str(folder), "PATH": "", "HOME": str(folder)},
    )  # fmt: skip


def test_a_stage_is_a_room_and_a_line(copy: Path) -> None:
    added(
        copy,
        "nouns/weight.py",
        """
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Weight:
    \"\"\"Of the fibers [kg].\"\"\"

    kilograms: float
""",
    )
    added(copy, "weigh/__init__.py", "")
    added(
        copy,
        "weigh/settings.py",
        """
from pydantic import BaseModel, ConfigDict, Field


class WeighSettings(BaseModel):
    \"\"\"How fibers are weighed.\"\"\"

    model_config = ConfigDict(frozen=True, extra="forbid")

    fiber_density: float = Field(default=900.0, description="Density of the fibers [kg/m3].")
""",
    )
    added(
        copy,
        "weigh/make.py",
        """
import math

from pipeline.line import store
from pipeline.nouns.fibers import Mat
from pipeline.nouns.weight import Weight


def make(results, into, progress):
    mat = results.read(Mat)
    area = math.pi * mat.radius[mat.segment_fibers()] ** 2
    weight = Weight(float((area * mat.segment_lengths()).sum() * results.case.weigh.fiber_density))
    store.write_json(into / "weight.json", weight)
    return {"kilograms": weight.kilograms}
""",
    )
    added(
        copy,
        "weigh/tables.py",
        """
from pipeline.nouns.section import Facts, Section, Table
from pipeline.nouns.weight import Weight


def tables(results):
    return (Table("weight", ("", ""), (("fibers", f"{results.read(Weight).kilograms:.3g} kg"),)),)


def section(results):
    weight = results.get(Weight)
    return Section("weight", "Weight", "What it weighs", (Facts((("fibers", str(weight)),)),)) if weight else None
""",
    )
    added(
        copy,
        "weigh/stage.py",
        """
from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.fibers import Mat
from pipeline.nouns.weight import Weight
from pipeline.weigh.settings import WeighSettings

WEIGH = Stage(
    name="weigh",
    about="What the fibers weigh.",
    make=Entry("pipeline.weigh.make:make"),
    needs=needing(Mat),
    gives={Weight: "weight.json"},
    settings=WeighSettings,
    tables=Entry("pipeline.weigh.tables:tables"),
    section=Entry("pipeline.weigh.tables:section"),
)
""",
    )
    # the one line of the registry, and its import
    registered(copy, "line/stages.py", "    SURFACE,\n", "    WEIGH,\n")
    registered(copy, "line/stages.py", "from pipeline.surface.stage", "from pipeline.weigh.stage import WEIGH\n")
    done = fibertwin(copy, "run", "case.toml", "--until", "weigh", "--set", "weigh.fiber_density=1800")
    assert done.returncode == 0, done.stderr
    assert re.search(r"fibers +[\d.e-]+ kg", done.stdout)
    heavy = json.loads((copy / "runs/case/weigh/weight.json").read_text())["kilograms"]
    again = fibertwin(copy, "run", "case.toml", "--until", "weigh", "--json")
    stages = {stage["stage"]: stage for stage in json.loads(again.stdout)["stages"]}
    assert stages["weigh"]["why"] == ["weigh.fiber_density changed from 1800.0 to 900.0"]
    assert stages["mat"]["how"] == "reused"
    assert stages["weigh"]["counts"]["kilograms"] == pytest.approx(heavy / 2, rel=1e-12)
    assert "weigh" in json.loads(fibertwin(copy, "schema").stdout)["properties"]
    nonsense = fibertwin(copy, "run", "case.toml", "--set", "weigh.density=1")
    assert (nonsense.returncode, "weigh.density: unknown key" in nonsense.stderr) == (2, True)
    page = fibertwin(copy, "report", "runs/case")
    assert page.returncode == 0, page.stderr
    assert "What it weighs" in (copy / "runs/case/report/report.html").read_text()


def test_a_model_is_a_formula_and_a_line(copy: Path) -> None:
    added(
        copy,
        "analytics/formulas/toy.py",
        """
def toy(solidity):
    return 42.0 * solidity
""",
    )
    registered(
        copy, "analytics/models/pressure_models.py", '        "kuwabara": PressureModel(\n',
        '        "toy": PressureModel("Toy (2026)", "toys", 0.0, 1.0, "exact for toys", _stuck(toy)),\n',
    )  # fmt: skip
    registered(
        copy, "analytics/models/pressure_models.py", "from pipeline.errors import",
        "from pipeline.analytics.formulas.toy import toy\n",
    )  # fmt: skip
    words = ("predict", "--solidity", "0.05", "--thickness", "47 um", "--fiber-diameter", "1 um", "--json")
    done = fibertwin(copy, *words, "--pressure-model", "toy")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["pressure_drop"]["toy"] > 0
    assert '"toy"' in fibertwin(copy, "schema").stdout


def test_an_engine_is_a_room_and_a_line(copy: Path) -> None:
    added(copy, "mesh/engines/toy/__init__.py", "")
    added(
        copy, "mesh/engines/toy/engine.py", """
from pydantic import Field

from pipeline.mesh.engines.engine import Engine, EngineSettings


class ToySettings(EngineSettings):
    \"\"\"What only the toy reads.\"\"\"

    coarser: float = Field(default=1.5, description="How much longer its edges are.")


def _mesh(domain, settings, progress, folder):
    from pipeline.mesh.engines.lattice.engine import LATTICE

    coarse = settings.changed(engine="lattice", edge=settings.edge * settings.own(ToySettings).coarser)
    return LATTICE.mesh(domain, coarse, progress, folder)


TOY = Engine("toy", "a lattice with longer edges", ToySettings, _mesh, "lower tetmesh.edge", lambda settings: ())
""",
    )  # fmt: skip
    registered(
        copy, "mesh/engines/registry.py", "from pipeline.mesh.engines.snappy.engine",
        "from pipeline.mesh.engines.toy.engine import TOY\n",
    )  # fmt: skip
    registry = copy / "pipeline/mesh/engines/registry.py"
    assert registry.read_text().count("(TETWILD, LATTICE, SNAPPY)") == 1
    registry.write_text(registry.read_text().replace("(TETWILD, LATTICE, SNAPPY)", "(TETWILD, LATTICE, SNAPPY, TOY)"))
    cells = {}
    for coarser in ("1.0", "1.5"):
        words = ("--set", "tetmesh.engine=toy", "--set", f"tetmesh.toy.coarser={coarser}", "--json")
        done = fibertwin(copy, "run", "case.toml", "--until", "tetmesh", *words)
        assert done.returncode == 0, done.stderr
        stages = {stage["stage"]: stage for stage in json.loads(done.stdout)["stages"]}
        cells[coarser] = stages["tetmesh"]["counts"]["cells"]
    assert stages["tetmesh"]["why"] == ["tetmesh.toy.coarser changed from 1.0 to 1.5"]
    assert cells["1.5"] < cells["1.0"]
    foreign = fibertwin(copy, "run", "case.toml", "--set", "tetmesh.toy.coarser=2")
    assert (foreign.returncode, "toy" in foreign.stderr) == (2, True)


def test_a_format_is_a_file_and_a_line(copy: Path) -> None:
    added(
        copy, "export/formats/toy.py", """
from pipeline.export.formats.format import Format


def write(mesh, folder, order):
    lines = (" ".join(map(repr, point)) for point in mesh.points.tolist())
    (folder / "points.toy").write_text("\\n".join(lines))


FORMAT = Format("toy", (".toy",), patches="lost", write=write)
""",
    )  # fmt: skip
    registered(copy, "export/formats/registry.py", "    *UNAVAILABLE,\n", "    toy.FORMAT,\n")
    registered(
        copy, "export/formats/registry.py", "from pipeline.export.formats.unavailable",
        "from pipeline.export.formats import toy\n",
    )  # fmt: skip
    words = ("--set", "tetmesh.engine=lattice", "--set", 'export.formats=["toy"]')
    done = fibertwin(copy, "run", "case.toml", "--until", "export", *words)
    assert done.returncode == 0, done.stderr
    quality = json.loads((copy / "runs/case/quality/quality.json").read_text())
    assert len((copy / "runs/case/export/toy/points.toy").read_text().splitlines()) == quality["points"]
    assert '"toy"' in fibertwin(copy, "schema").stdout
