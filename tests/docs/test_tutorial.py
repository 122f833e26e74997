"""The tutorial's commands are commands, and the quick ones run, in order, in an empty folder."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
import shlex
from pathlib import Path

import pytest

from pipeline.cli.app import app
from tests.cli.conftest import Fibertwin
from tests.cli.conftest import fibertwin as fibertwin  # the fixture

DOCS = Path(__file__).parents[2] / "docs"
TUTORIAL = (DOCS / "tutorial.md").read_text(encoding="utf-8")
PAGES = ("tutorial.md", "cluster.md", "questions.md")


def commands(page: str) -> list[list[str]]:
    """Give the commands of the page's shell blocks, as the shell would pass them."""
    blocks = re.findall(r"```(?:sh|bash)\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines() if line.startswith("fibertwin ")]
    return [shlex.split(line.replace("$SLURM_NTASKS", "8"))[1:] for line in lines]


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
