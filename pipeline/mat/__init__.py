"""Random fiber mats: drawn, deposited, measured, exchanged."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.mat.audit import Audit, audit
from pipeline.mat.exchange import read_fibers, write_fibers, write_spaceclaim
from pipeline.mat.generate import generate
from pipeline.mat.measures import MatMeasures, measure
from pipeline.mat.settings import (
    ArraySettings,
    BoxSettings,
    FileSettings,
    LayeredSettings,
    MatSettings,
    Stop,
)
from pipeline.mat.tally import Predict, StopReport, report_stop

__all__ = [
    "ArraySettings",
    "Audit",
    "BoxSettings",
    "FileSettings",
    "LayeredSettings",
    "MatMeasures",
    "MatSettings",
    "Predict",
    "Stop",
    "StopReport",
    "audit",
    "generate",
    "measure",
    "read_fibers",
    "report_stop",
    "write_fibers",
    "write_spaceclaim",
]
