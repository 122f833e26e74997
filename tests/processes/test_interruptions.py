"""Ctrl-C and SIGTERM in every command; ``python -m tests.processes.interruptions`` makes as many as one likes."""

# SPDX-License-Identifier: GPL-3.0-or-later

import random
import sys
from pathlib import Path

import pytest

from pipeline.cli.app import app
from pipeline.line.run import Run
from tests.processes.interruptions import COMMANDS, again, finish, interrupt, prepare

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere less is promised")

_ELSEWHERE = {"run", "cases", "schema", "doctor"}  # test_interruption.py has the first; the others write nothing


@pytest.fixture(scope="module")
def prepared(smoke: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("prepared")
    prepare(place, smoke.folder)
    return place


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("solved")
    prepare(place)
    return place


def test_no_command_is_left_out() -> None:
    named = {name for name in app if not name.startswith("-")}
    assert named - _ELSEWHERE <= {command.words[0] for command in COMMANDS.values()}


@pytest.mark.parametrize("name", ["init", "quality", "export", "measure", "twin"])
def test_a_command_that_is_interrupted_says_so_and_leaves_nothing(name: str, prepared: Path, tmp_path: Path) -> None:
    # a second and a half: most of what each takes, its imports first
    interrupt(COMMANDS[name], prepared, tmp_path, 1.5, random.Random(name))


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_ends_in_order_at_any_moment_and_then_does_its_work(
    name: str, solved: Path, tmp_path: Path
) -> None:
    command, draw = COMMANDS[name], random.Random(name)
    if not command.possible:
        pytest.skip(f"none of {', '.join(command.needs)} is there")
    seconds = finish(command, solved, tmp_path)
    for _ in range(3):
        interrupt(command, solved, tmp_path, seconds, draw)
        again(command, tmp_path)
