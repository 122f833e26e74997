"""What every test may use."""

# SPDX-License-Identifier: GPL-3.0-or-later

import shutil
import signal
from pathlib import Path

import pytest
from hypothesis import settings

from pipeline.case import read_case
from pipeline.line.run import Run, run

# a busy machine is no fault of the code's
settings.register_profile("fibertwin", deadline=None)
settings.load_profile("fibertwin")

# a job in a shell's background ignores Ctrl-C, and so would the programs that tests interrupt
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# pytest's own 1e-12 is more than any area or volume of a fiber in SI: with it, no such comparison could fail
type(pytest.approx(1.0)).DEFAULT_ABSOLUTE_TOLERANCE = 0.0  # type: ignore[attr-defined]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if shutil.which("checkMesh"):
        return
    skip = pytest.mark.skip(reason="OpenFOAM's programs are not on the PATH")
    for item in items:
        if "openfoam" in item.keywords:
            item.add_marker(skip)


@pytest.fixture(scope="session")
def smoke(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """Run the bundled smoke case once for every test that looks at a whole run."""
    case = read_case(Path(__file__).parent.parent / "cases" / "smoke.toml")
    folder = tmp_path_factory.mktemp("smoke") / "run"
    run(case, folder, until="compare")
    return Run(case, folder)
