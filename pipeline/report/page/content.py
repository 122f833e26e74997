"""What a page may show: of a run, of which every part but the case may be missing; of a mesh that is not ours."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pipeline.case import Case
from pipeline.mat.measures import MatMeasures
from pipeline.mesh.improve.finish import TetmeshMeasures
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import QualityReport
from pipeline.nouns.surface import Surface
from pipeline.quality.settings import QualitySettings


@dataclass(frozen=True, eq=False, slots=True)
class ReportContent:
    """The nouns of a run, as far as it went.

    Parameters
    ----------
    folder : Path
        Of the run, as commands on the page should name it; its last part is the run's name.
    case : Case
    mat, mat_measures, surface, domain, mesh, mesh_measures, quality, comparison, solution : optional
        What the stages made.
    manifests : dict of str to dict
        By stage, in the order of the line: what made it.
    left_out : tuple of str
        Stages whose results are there, but of another case or of another state of an earlier stage.
    """

    folder: Path
    case: Case
    mat: Mat | None = None
    mat_measures: MatMeasures | None = None
    surface: Surface | None = None
    domain: FluidDomain | None = None
    mesh: FaceMesh | None = None
    mesh_measures: TetmeshMeasures | None = None
    quality: QualityReport | None = None
    comparison: Comparison | None = None
    solution: Solution | None = None
    manifests: dict[str, dict[str, Any]] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the run."""
        return self.folder.resolve().name


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
