"""One page that says what was made and whether to trust it."""

from pipeline.report.content import MeshContent, ReportContent, SourceFile
from pipeline.report.mesh_page import write_mesh_page
from pipeline.report.page import PAGE, subject_of, write_report

__all__ = ["PAGE", "MeshContent", "ReportContent", "SourceFile", "subject_of", "write_mesh_page", "write_report"]
