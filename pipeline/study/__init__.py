"""A case run many times: keys swept, seeds repeated, means with their confidence."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.study.settings import Study, read_study
from pipeline.study.study import StudyResult, carry_out_study

__all__ = ["Study", "StudyResult", "carry_out_study", "read_study"]
