"""Says in every source file under which license it is: ``python -m tests.packaging.headers`` adds what lacks.

The line stands below the module's first docstring, whose first line says what the module is for.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
LICENSE = "SPDX-License-Identifier: GPL-3.0-or-later"
LINE = re.compile(rf"^(# {LICENSE}|/\* {LICENSE} \*/)$", re.MULTILINE)
_KINDS = (".py", ".js", ".css")
_FOLDERS = ("pipeline", "tests", "docs", "benchmarks")


def sources() -> list[Path]:
    """Every source file that has something in it."""
    found = [path for folder in _FOLDERS for path in (ROOT / folder).rglob("*") if path.suffix in _KINDS]
    return sorted(path for path in found if path.stat().st_size and "__pycache__" not in path.parts)


def missing() -> list[Path]:
    """Give the files that do not say it within their first lines of code."""
    return [path for path in sources() if not LINE.search(path.read_text(encoding="utf-8"))]


def with_header(text: str, suffix: str) -> str:
    """Give a source with its line of license: below the docstring that it opens with, or at its top."""
    if suffix != ".py":
        return f"/* {LICENSE} */\n{text}"
    body = ast.parse(text).body
    documented = body and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant)
    lines = text.splitlines(keepends=True)
    end = (body[0].end_lineno or 0) if documented else 0
    rest = "".join(lines[end:]).lstrip("\n")
    above = "".join(lines[:end]) + "\n" if end else ""
    return f"{above}# {LICENSE}\n" + (f"\n{rest}" if rest else "")


def main() -> None:
    """Add the line where it is missing, and say where."""
    for path in missing():
        path.write_text(with_header(path.read_text(encoding="utf-8"), path.suffix), encoding="utf-8")
        sys.stdout.write(f"{path.relative_to(ROOT)}\n")


if __name__ == "__main__":
    main()
