"""The tutorial's commands are commands, and the quick ones run, in order, in an empty folder."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import re
import shlex
from pathlib import Path

import pytest

from pipeline.cli.app import app
from tests.cli.conftest import Fibertwin
from tests.cli.conftest import fibertwin as fibertwin  # the fixture

DOCS = Path(__file__).parents[2] / "docs"
TUTORIAL = (DOCS / "tutorial.md").read_text(encoding="utf-8")
PAGES = ("tutorial.md", "tutorial-micrograph.md", "cluster.md", "questions.md")


def commands(page: str) -> list[list[str]]:
    """Give the commands of the page's shell blocks, as the shell would pass them."""
    blocks = re.findall(r"```(?:sh|bash)\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines() if line.startswith("fibertwin ")]
    return [shlex.split(line.partition(" > ")[0].replace("$SLURM_NTASKS", "8"))[1:] for line in lines]


def quick(command: list[str]) -> bool:
    if command[0] == "run":
        return "--until" in command and command[command.index("--until") + 1] in ("mat", "surface")
    return command[0] in ("cases", "init", "predict")


@pytest.mark.parametrize("page", PAGES)
def test_every_command_has_the_options_that_it_is_given(page: str) -> None:
    assert commands(page)
    for command in commands(page):
        # parsed in full: an unknown option or a wrong type is an error
        app.parse_args(command, exit_on_error=False, print_error=False)


def test_the_quick_commands_run_one_after_the_other(
    fibertwin: Fibertwin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for language, name in (("csv", "fibers.csv"), ("toml", "own.toml")):
        block = re.search(rf"```{language}\n(.*?)```", TUTORIAL, re.DOTALL)
        assert block
        (tmp_path / name).write_text(block[1], encoding="utf-8")
    runnable = [command for command in commands("tutorial.md") if quick(command)]
    assert len(runnable) >= 8
    for command in runnable:
        said = fibertwin(*command)
        assert (said.code, said.err) == (0, ""), command
    assert (tmp_path / "runs/own/surface/surface.stl").is_file()


def test_a_picture_becomes_a_twin_as_the_page_says(
    fibertwin: Fibertwin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = (DOCS / "tutorial-micrograph.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    for name, block in zip(("real.toml", "measured.toml"), blocks, strict=True):
        (tmp_path / name).write_text(block, encoding="utf-8")
    taken, measured, matched, nearest, looked_at, _ = commands("tutorial-micrograph.md")
    assert fibertwin(*taken).code == 0
    (tmp_path / "web.json").write_text(fibertwin(*measured).out, encoding="utf-8")
    told = json.loads((tmp_path / "web.json").read_text())["diameter"]
    # what the page says of the mat's own mean lies within what the picture's interval allows
    assert told["mean_interval"][0] < 0.98e-6 < told["mean_interval"][1]
    assert fibertwin(*matched).code == 0
    assert fibertwin(*nearest).code == 3
    assert fibertwin(*looked_at).code == 0
    # the medium's own solidity comes out, which nobody told: as near as two of so few fibers are alike
    made = json.loads((tmp_path / "runs/twin/mat/measures.json").read_text())
    assert made["solidity"] == pytest.approx(0.089, rel=0.15)
    assert sorted(path.name for path in (tmp_path / "runs/twin/micrograph").glob("*.png")) == [
        "measured.png",
        "twin.png",
    ]
