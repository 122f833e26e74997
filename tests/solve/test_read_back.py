# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest

from pipeline.openfoam.process import tail
from pipeline.solve.read_back import DRAG, FLOW_IN, FLOW_OUT, PRESSURE_IN, PRESSURE_OUT, history, residuals, table


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


@pytest.mark.parametrize("behind", [PRESSURE_IN, PRESSURE_OUT, FLOW_IN, FLOW_OUT, DRAG])
def test_an_iteration_counts_once_every_table_has_it(tmp_path: Path, behind: str) -> None:
    # a solver that was ended between two of its function objects: one table lacks the last iteration
    for name in (PRESSURE_IN, PRESSURE_OUT, FLOW_IN, FLOW_OUT, DRAG):
        file = "force.dat" if name == DRAG else "surfaceFieldValue.dat"
        last = 2 if name == behind else 3
        lines = "".join(f"{at}\t{at}.5\t0\t0\n" for at in range(1, last + 1))
        write(tmp_path / "postProcessing" / name / "0" / file, lines)
    np.testing.assert_array_equal(table(tmp_path)[:, 0], [1.0, 2.0])
