"""One place for the version: what else names it agrees."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_citation_and_changelog_are_of_the_version_in_pyproject() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.findall(r"^version: (\S+)$", citation, re.MULTILINE) == [version]
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## (\S+)", changes, re.MULTILINE)
    assert newest
    assert newest[1] == version
    # nowhere in the program: it reads the installed package
    sources = " ".join(path.read_text(encoding="utf-8") for path in (ROOT / "pipeline").rglob("*.py"))
    assert f'"{version}"' not in sources
