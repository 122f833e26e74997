"""What `fibertwin converge` left beside the stages of a run."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.errors import StageError
from pipeline.line import store
from pipeline.nouns.convergence import RESULT, ConvergedDrop


def read_convergence(folder: Path) -> ConvergedDrop | None:
    """Read what `fibertwin converge` left in a run's folder; None where it left nothing that can be read."""
    try:
        return store.load_json(ConvergedDrop, folder / RESULT)
    except StageError:
        return None
