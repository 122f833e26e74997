"""The command line in this process: what it prints, and the exit code that a shell would see."""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from pipeline.cli.app import main


@dataclass(frozen=True)
class Said:
    code: int
    out: str
    err: str


Fibertwin = Callable[..., Said]


@pytest.fixture
def fibertwin(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Fibertwin:
    monkeypatch.setenv("COLUMNS", "80")

    def call(*arguments: str | Path) -> Said:
        monkeypatch.setattr(sys, "argv", ["fibertwin", *map(str, arguments)])
        capsys.readouterr()
        try:
            main()
            code = 0
        except SystemExit as ending:
            code = int(ending.code or 0)
        said = capsys.readouterr()
        return Said(code, said.out, said.err)

    return call
