"""From measured filter data back to the settings of a mat."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.design.targets import Target, read_targets
from pipeline.design.tune import Tuned, tune

__all__ = ["Target", "Tuned", "read_targets", "tune"]
