"""What a mesh is like, by the solver's own definitions."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.quality.judge import cell_fields, judge, measure
from pipeline.quality.settings import QualitySettings

__all__ = ["QualitySettings", "cell_fields", "judge", "measure"]
