"""A few inputs for every reader in each run of the tests; docs/security.md tells of the many."""

# SPDX-License-Identifier: GPL-3.0-or-later

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.security.inputs import TARGETS
from tests.security.pictures import TARGETS as PICTURES
from tests.security.run_folders import TARGETS as RUN_FOLDERS


@pytest.mark.parametrize("name", TARGETS)
@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_only_a_result_or_our_own_error_comes_out(name: str, data: st.DataObject) -> None:
    TARGETS[name](data)


@pytest.mark.parametrize("name", RUN_FOLDERS)
@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_run_in_a_broken_folder_gives_the_same_results_or_our_own_error(name: str, data: st.DataObject) -> None:
    RUN_FOLDERS[name](data)


@pytest.mark.parametrize("name", PICTURES)
@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_picture_or_a_tomogram_is_read_or_refused(name: str, data: st.DataObject) -> None:
    PICTURES[name](data)
