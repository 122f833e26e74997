"""One page that says what was made and whether to trust it, and one scene to turn."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.report.content import MeshContent, ReportContent, SourceFile
from pipeline.report.page import PAGE, subject_of, write_report

__all__ = ["PAGE", "MeshContent", "ReportContent", "SourceFile", "subject_of", "write_report"]
