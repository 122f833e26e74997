"""What a result depends on in the program follows from the program."""

# SPDX-License-Identifier: GPL-3.0-or-later

import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

import grimp
import pytest

from pipeline.line.code import ROOT, closure, code_of, libraries_of, read_source, versions
from pipeline.line.stages import LINE

MAKERS = {stage.name: stage.make.module for stage in LINE}


def text_of(module: str) -> str:
    place = ROOT.parent.joinpath(*module.split("."))
    return (place / "__init__.py" if place.is_dir() else place.with_suffix(".py")).read_text()


@pytest.fixture(scope="module")
def graph() -> grimp.ImportGraph:
    return grimp.build_graph("pipeline", exclude_type_checking_imports=True, cache_dir=None)


@pytest.mark.parametrize("maker", MAKERS.values())
def test_what_a_maker_imports_is_what_grimp_finds_and_what_is_named_in_texts(
    maker: str, graph: grimp.ImportGraph
) -> None:
    # a module that is run by its name, or loaded when it is needed, is invisible to grimp
    named = {
        text.partition(":")[0]
        for module in closure(maker)
        for node in ast.walk(ast.parse(text_of(module)))
        if isinstance(node, ast.Constant) and isinstance(text := node.value, str)
        if re.fullmatch(r"pipeline(\.\w+)+(:\w+)?", text) and text.partition(":")[0] in graph.modules
    }
    expected = {maker}
    waiting = {maker, *named}
    while waiting:
        module = waiting.pop()
        expected.add(module)
        waiting |= graph.find_modules_directly_imported_by(module) - expected
    # packages hold nothing but their docstrings: what is imported from them is a module
    assert set(closure(maker)) == expected - {"pipeline"}


def test_packages_hold_nothing() -> None:
    # a name that a package gave would hide from where it comes; the package itself loads its names when they are used
    for path in ROOT.rglob("__init__.py"):
        body = ast.parse(path.read_text()).body
        if path.parent != ROOT:
            assert all(isinstance(node, ast.Expr) for node in body), path


@pytest.mark.parametrize(
    ("stage", "module"),
    [
        ("compare", "pipeline/compare/make.py"),
        ("compare", "pipeline/line/store.py"),
        ("mat", "pipeline/mat/contact.py"),
        ("tetmesh", "pipeline/mesh/engines/ftetwild/worker.py"),
        ("report", "pipeline/report/views/painter.py"),
        ("report", "pipeline/report/page/templates/report.html.jinja"),
    ],
)
def test_a_stage_depends_on_its_own_function_and_on_what_that_runs(stage: str, module: str) -> None:
    assert module in code_of(MAKERS[stage])


@pytest.mark.parametrize(
    ("stage", "module"),
    [("solve", "pipeline/report/page/charts.py"), ("tetmesh", "pipeline/analytics/tables/plots.py"),
     ("mat", "pipeline/surface/union.py"), ("surface", "pipeline/case.py")],
)  # fmt: skip
def test_a_stage_does_not_depend_on_what_it_does_not_run(stage: str, module: str) -> None:
    assert (ROOT.parent / module).is_file()
    assert module not in code_of(MAKERS[stage])


def test_libraries_are_those_that_the_modules_import() -> None:
    assert {"numpy", "numba"} <= libraries_of(MAKERS["mat"]).keys()
    assert {"numpy", "manifold3d"} <= libraries_of(MAKERS["surface"]).keys()
    assert "pytetwild" in libraries_of(MAKERS["tetmesh"])
    assert "jinja2" not in libraries_of(MAKERS["tetmesh"])
    # imported as PIL, installed as pillow
    assert "pillow" in versions(["PIL"])


def test_comments_docstrings_and_layout_do_not_count_and_everything_else_does() -> None:
    plain = read_source("def f(x):\n    return x + 1\n")
    told = read_source('"""Why."""\n\n# how\ndef f(x):\n    """What."""\n    return (x\n            + 1)  # because\n')
    assert told.digest == plain.digest
    assert read_source("def f(x):\n    return x + 2\n").digest != plain.digest
    assert read_source("def f(y):\n    return y + 1\n").digest != plain.digest
    # a text that is no docstring is a value
    assert read_source('x = "a"').digest != read_source('x = "b"').digest


def test_what_is_for_types_only_does_not_count() -> None:
    text = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import numpy\nelse:\n    import scipy\n"
    assert read_source(text).names == ("scipy", "typing.TYPE_CHECKING")


def test_an_edited_function_changes_the_digest_of_just_the_stages_that_run_it(tmp_path: Path) -> None:
    copy = tmp_path / "pipeline"
    shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns("__pycache__"))
    program = (
        "import json; from pipeline.line.code import code_of; from pipeline.line.stages import LINE;"
        "print(json.dumps({s.name: code_of(s.make.module) for s in LINE}))"
    )

    def digests() -> dict[str, dict[str, str]]:
        import json

        done = subprocess.run(
            [sys.executable, "-c", program], cwd=tmp_path, env={"PYTHONPATH": str(tmp_path), "PATH": ""},
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        found: dict[str, dict[str, str]] = json.loads(done.stdout)
        return found

    before = digests()
    make = copy / "compare" / "make.py"
    # what was done once without anything being made again: the solidity of the mesh halved
    text = make.read_text()
    assert "solidity = 1.0 - air" in text
    make.write_text(text.replace("solidity = 1.0 - air", "solidity = 0.5 - air"))
    # a remark remade everything once
    segments = copy / "geometry" / "segments.py"
    segments.write_text(segments.read_text() + "\n# a remark\n")
    after = digests()
    assert [name for name in before if before[name] != after[name]] == ["compare"]
