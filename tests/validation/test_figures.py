"""README quotes the recorded figures and no others."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json

from validation.figures import FIGURES, README, written


def test_readme_shows_the_recorded_figures() -> None:
    page = README.read_text(encoding="utf-8")
    figures = json.loads(FIGURES.read_text(encoding="utf-8"))
    assert written(page, figures) == page
    # a figure that is another would be noticed
    other = {**figures, "cells": figures["cells"] + 1000}
    assert written(page, other) != page
