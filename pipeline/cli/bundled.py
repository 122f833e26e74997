"""The case files that come with fibertwin: found by their bare name, in a checkout and in an installed package."""

# SPDX-License-Identifier: GPL-3.0-or-later

import difflib
from pathlib import Path

from pipeline.errors import CaseError

_PACKAGE = Path(__file__).parent.parent


def bundled_folder() -> Path:
    """Folder of the bundled case files: in the installed package, or beside it in a checkout."""
    installed = _PACKAGE / "bundled_cases"
    return installed if installed.is_dir() else _PACKAGE.parent / "cases"


def bundled() -> dict[str, Path]:
    """Every bundled case by its name, such as ``smoke``; a study's name starts with ``studies/``."""
    folder = bundled_folder()
    return {
        path.relative_to(folder).with_suffix("").as_posix(): path
        for path in sorted(folder.rglob("*.toml"), key=lambda path: (len(path.parts), path.name))
    }


def found(path: Path) -> Path:
    """Give a file that is there as it is, and a bare name as the bundled file of that name.

    Raises
    ------
    CaseError
        If neither is there.
    """
    if path.exists():
        return path
    known = bundled()
    if path.as_posix() in known:
        return known[path.as_posix()]
    near = difflib.get_close_matches(path.stem, known, n=1)
    advice = f"did you mean {near[0]}?" if near else "fibertwin cases lists them"
    raise CaseError(f"there is no file {path}, and no bundled case of that name; {advice}")


def story(path: Path) -> str:
    """Give what a case file says about itself in the comment that it opens with."""
    lines = path.read_text(encoding="utf-8").splitlines()
    opening = lines[: next((k for k, line in enumerate(lines) if not line.startswith("#")), len(lines))]
    return " ".join(line.lstrip("# ") for line in opening)
