"""From measured filter data back to the settings of a mat."""

from pipeline.design.targets import Target, read_targets
from pipeline.design.tune import Tuned, tune

__all__ = ["Target", "Tuned", "read_targets", "tune"]
