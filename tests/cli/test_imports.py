"""A command loads what it needs and nothing else: loading the rest is what made commands slow."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import subprocess
import sys
from pathlib import Path

import pytest

NUMBERS = ("predict", "--solidity", "0.09", "--thickness", "47 um", "--fiber-diameter", "1.4 um")
HEAVY = ("numba", "scipy", "pint", "jinja2", "matplotlib", "pyvista", "vtkmodules", "meshio", "trimesh", "distributed")


def loaded(words: tuple[str, ...], folder: Path) -> set[str]:
    program = (
        "import contextlib, io, json, sys\n"
        "from pipeline.cli.entry import main\n"
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):\n"
        f"    sys.argv[1:] = {list(words)!r}\n"
        "    main()\n"
        "print(json.dumps(sorted({name.split('.')[0] for name in sys.modules})))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=folder)
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize(
    ("words", "spared"),
    [
        (("--help",), (*HEAVY, "numpy", "pydantic")),
        (("schema",), (*HEAVY, "psutil")),
        (NUMBERS, (*HEAVY, "psutil")),
        # a mat is grown by compiled loops; numba itself loads a part of scipy
        (("run", "default", "--until", "mat", "--quiet"), tuple(set(HEAVY) - {"numba", "scipy"})),
    ],
)
def test_a_command_does_not_load_what_it_does_not_use(
    words: tuple[str, ...], spared: tuple[str, ...], tmp_path: Path
) -> None:
    assert loaded(words, tmp_path).isdisjoint(spared)
