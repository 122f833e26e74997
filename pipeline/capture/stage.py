"""The stage `capture`: what the filter catches."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.capture.settings import CaptureSettings
from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.capture import Capture
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh

CAPTURE = Stage(
    name="capture",
    about="Particles sent through the solved flow, and what the fibers catch of them.",
    make=Entry("pipeline.capture.make:make"),
    needs=needing(Mat, FluidDomain, FaceMesh, Comparison, Solution),
    takes=needing(FlowField),
    gives={Capture: "capture.json"},
    settings=CaptureSettings,
    reads=("flow", "enclosure"),
    units={"most_penetrating": "nm", "least_efficiency": "%"},
    obstacle=Entry("pipeline.capture.make:obstacle"),
    asked=True,
    tables=Entry("pipeline.capture.tables:tables"),
    section=Entry("pipeline.report.page.capture_section:capture"),
)
