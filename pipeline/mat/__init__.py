"""Random fiber mats: drawn, deposited, measured, exchanged."""

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

__all__ = [
    "ArraySettings",
    "BoxSettings",
    "FileSettings",
    "LayeredSettings",
    "MatMeasures",
    "MatSettings",
    "Stop",
    "generate",
    "measure",
]
