"""One page that says what was made and whether to trust it."""

from pipeline.report.content import ReportContent
from pipeline.report.page import PAGE, subject_of, write_report

__all__ = ["PAGE", "ReportContent", "subject_of", "write_report"]
