"""What every test may use."""

import shutil

import pytest
from hypothesis import settings

# a busy machine is no fault of the code's
settings.register_profile("fibertwin", deadline=None)
settings.load_profile("fibertwin")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if shutil.which("checkMesh"):
        return
    skip = pytest.mark.skip(reason="OpenFOAM's programs are not on the PATH")
    for item in items:
        if "openfoam" in item.keywords:
            item.add_marker(skip)
