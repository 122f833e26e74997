"""What the page of questions shows works: its case file is one, and its pages have the titles that it leads to."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
import tomllib
from pathlib import Path

from pipeline.case import Case
from pipeline.mat.generate import generate

PAGE = (Path(__file__).parents[2] / "docs/questions.md").read_text(encoding="utf-8")


def test_the_case_file_with_the_laws_grows_a_mat() -> None:
    (text,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    mat = generate(Case.model_validate(tomllib.loads(text)).mat)
    # the coverage of 1 takes eighteen fibers of 1.4 um on 20 um, thinner or thicker ones a few more or less
    assert 10 <= mat.fibers <= 30
    assert mat.radius.std() > 0.05 * mat.radius.mean()
