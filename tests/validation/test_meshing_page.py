"""docs/meshing.md shows what was measured and nothing else."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace

import pytest

from benchmarks.meshing import DATA, PAGE, REFERENCE, Row, contact_table, edge_table, limit, quality_table
from validation.records import read_records


@pytest.fixture
def rows() -> list[Row]:
    return read_records(DATA, Row)


def test_the_page_shows_the_recorded_runs(rows: list[Row]) -> None:
    page = PAGE.read_text(encoding="utf-8")
    for shown in (edge_table, quality_table, contact_table):
        assert shown(rows) in page
    # another pressure drop would be noticed
    assert edge_table([replace(row, drop=1.01 * row.drop) for row in rows]) not in page


def test_errors_are_against_the_finest_mesh_and_both_meshers_hold_one_percent_at_the_default_edge(
    rows: list[Row],
) -> None:
    elements = {(row.job, row.engine, row.edge): row.drop for row in rows if row.solver == "stokes"}
    exact = limit(rows)
    assert elements[REFERENCE.name, "tetwild", REFERENCE.edge] == exact
    for engine in ("tetwild", "lattice"):
        assert elements["edge", engine, 0.6] == pytest.approx(exact, rel=0.01)
