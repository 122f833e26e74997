# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.openfoam.process import tail
from pipeline.solve.read_back import history, residuals


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def test_a_restart_replaces_what_it_computes_again(tmp_path: Path) -> None:
    write(tmp_path / "postProcessing/p/0/surfaceFieldValue.dat", "# Time\tvalue\n1\t5.0\n2\t4.0\n3\t3.5\n4\t3.0\n")
    write(tmp_path / "postProcessing/p/2/surfaceFieldValue.dat", "# Time\tvalue\n3\t7.0\n")
    assert history(tmp_path, "p").tolist() == [[1, 5], [2, 4], [3, 7]]


def test_a_half_written_line_is_not_read(tmp_path: Path) -> None:
    write(tmp_path / "postProcessing/p/0/surfaceFieldValue.dat", "1\t5.0\n2\t4.0\n3\t3.")
    assert history(tmp_path, "p").tolist() == [[1, 5], [2, 4]]


def test_the_force_and_not_the_moment_is_read(tmp_path: Path) -> None:
    write(tmp_path / "postProcessing/drag/0/moment.dat", "1\t(9 9 9)\t(9 9 9)\t(9 9 9)\n")
    write(tmp_path / "postProcessing/drag/0/force.dat", "1\t(1 2 3)\t(4 5 6)\t(7 8 9)\n")
    assert history(tmp_path, "drag", 3).tolist() == [[1, 3]]


def test_nothing_written_is_an_empty_history(tmp_path: Path) -> None:
    assert history(tmp_path, "p").shape == (0, 2)
    assert tail(tmp_path / "log") == "(no log)"


def test_the_latest_residuals_count() -> None:
    text = "Solving for Ux, Initial residual = 1, Final\nSolving for Ux, Initial residual = 2.5e-03, Final\n"
    assert residuals(text) == {"Ux": 0.0025}
