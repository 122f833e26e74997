"""Every source file says under which license it is."""

# SPDX-License-Identifier: GPL-3.0-or-later

from tests.packaging.headers import LICENSE, LINE, ROOT, missing, sources, with_header


def test_every_source_file_names_its_license() -> None:
    assert len(sources()) > 250
    # python -m tests.packaging.headers adds the line
    assert [path.relative_to(ROOT).as_posix() for path in missing()] == []


def test_the_line_stands_below_what_the_module_is_for_and_once() -> None:
    for path in sources():
        text = path.read_text(encoding="utf-8")
        assert len(LINE.findall(text)) == 1, path
        if path.suffix == ".py" and text.startswith('"""'):
            below = text[text.index('"""', 3) + 3 :].lstrip("\n")
            assert below.startswith(f"# {LICENSE}\n"), path


def test_the_license_is_the_packages() -> None:
    assert f'license = "{LICENSE.split(": ")[1]}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_a_module_without_a_docstring_begins_with_the_line() -> None:
    assert with_header("import sys\n", ".py") == f"# {LICENSE}\n\nimport sys\n"
    assert with_header('"""What for."""\n', ".py") == f'"""What for."""\n\n# {LICENSE}\n'
    assert with_header("body {}\n", ".css") == f"/* {LICENSE} */\nbody {{}}\n"
