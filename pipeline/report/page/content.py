"""What the page of a mesh that is not ours shows."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from pathlib import Path

from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import QualityReport
from pipeline.quality.settings import QualitySettings


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file that something was read from: where, how many bytes, and the SHA-256 of them."""

    path: str
    size: int
    digest: str


@dataclass(frozen=True, eq=False, slots=True)
class MeshContent:
    """A mesh that is not ours, and what was found of it.

    Parameters
    ----------
    path : Path
        What was judged, as the command named it.
    mesh : FaceMesh
    quality : QualityReport
    limits : QualitySettings
    limits_of : str
        Whose the limits are, in words.
    files : tuple of SourceFile
    """

    path: Path
    mesh: FaceMesh
    quality: QualityReport
    limits: QualitySettings
    limits_of: str
    files: tuple[SourceFile, ...]
