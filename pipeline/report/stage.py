"""The stage `report`: everything on one page."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.line.stage import Entry, Stage

PAGE = "report.html"
"""File of the stage that holds the page."""
PAGE_JSON = "page.json"
"""File of the stage that holds all that the page shows, for programs."""

REPORT = Stage(
    name="report",
    about="All of it on one page.",
    make=Entry("pipeline.report.make:make"),
    shows_run=True,
    section=Entry("pipeline.report.page.flow_sections:prediction"),
)
