"""Analytical models of fiber filters: pressure drop, single-fiber efficiency, and what follows from them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.analytics.comparison import compare
from pipeline.analytics.growth import predictor
from pipeline.analytics.options import read_options
from pipeline.analytics.prediction import Prediction, filter_of_comparison, filter_of_mat, predict
from pipeline.analytics.tables import comparison_tables, prediction_tables

__all__ = [
    "Prediction",
    "compare",
    "comparison_tables",
    "filter_of_comparison",
    "filter_of_mat",
    "predict",
    "prediction_tables",
    "predictor",
    "read_options",
]
