"""Engines describe themselves: the case file's tables, what is refused, and advice follow from one registry."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
import tomllib
from pathlib import Path

import pytest

from pipeline.case import Case, override, validate
from pipeline.enclosure.duct import enclose
from pipeline.errors import CaseError, StageError
from pipeline.mat.generate import generate
from pipeline.mesh.engines.ftetwild.engine import TetwildSettings
from pipeline.mesh.engines.lattice.engine import LatticeSettings
from pipeline.mesh.engines.registry import DEFAULT, ENGINES
from pipeline.mesh.fill import fill
from pipeline.mesh.settings import TetmeshSettings
from pipeline.surface.union import unite

SMOKE = tomllib.loads((Path(__file__).parents[2] / "cases/smoke.toml").read_text())
OWN_KEYS = sorted((name, key) for name, engine in ENGINES.items() for key in engine.settings.model_fields)


def case(*overrides: str) -> Case:
    return validate(override(SMOKE, overrides), "case.toml")


@pytest.mark.parametrize("name", ENGINES)
def test_the_chosen_engines_table_is_always_written_out(name: str) -> None:
    # what a result depends on has to show a default that changes
    settings = TetmeshSettings(engine=name)
    assert isinstance(getattr(settings, name), ENGINES[name].settings)
    written = settings.model_dump(mode="json")
    assert set(written) & set(ENGINES) == {name}
    assert TetmeshSettings.model_validate(written) == settings


@pytest.mark.parametrize(("chosen", "other"), list(itertools.permutations(ENGINES, 2)))
def test_another_engines_table_is_refused_by_name(chosen: str, other: str) -> None:
    with pytest.raises(CaseError, match=rf'\[tetmesh\.{other}\] means nothing to tetmesh\.engine = "{chosen}"'):
        case(f"tetmesh.engine={chosen}", f"tetmesh.{other}={{}}")


@pytest.mark.parametrize("chosen", ENGINES)
@pytest.mark.parametrize(("owner", "key"), OWN_KEYS)
def test_an_engines_key_outside_its_table_is_refused_with_its_place(chosen: str, owner: str, key: str) -> None:
    # where it stood before each engine had a table
    with pytest.raises(CaseError, match=rf"tetmesh\.{key}: no key of \[tetmesh\]; write .*tetmesh\.{owner}\.{key}"):
        case(f"tetmesh.engine={chosen}", f"tetmesh.{key}=4")


def test_a_key_of_another_engines_table_is_refused_within_a_table() -> None:
    with pytest.raises(CaseError, match=r"tetmesh\.lattice\.passes: unknown key"):
        case("tetmesh.engine=lattice", "tetmesh.lattice.passes=4")


@pytest.mark.parametrize("name", ENGINES)
def test_advice_for_better_cells_is_a_case_that_is_accepted_and_differs(name: str) -> None:
    plain = case(f"tetmesh.engine={name}")
    better = case(f"tetmesh.engine={name}", *ENGINES[name].better(plain.tetmesh))
    assert better.tetmesh != plain.tetmesh


def test_a_changed_copy_takes_keys_of_both_tables_and_drops_another_engines() -> None:
    settings = TetmeshSettings(engine="tetwild").changed(edge=0.5, passes=7)
    assert (settings.edge, settings.own(TetwildSettings).passes) == (0.5, 7)
    other = settings.changed(engine="lattice")
    assert (other.edge, other.own(LatticeSettings)) == (0.5, LatticeSettings())


def test_a_scaled_copy_keeps_what_is_no_length() -> None:
    before = TetmeshSettings(engine="tetwild")
    after = before.scaled(0.5)
    assert (after.edge, after.growth, after.largest_edge) == (0.3, 0.5, 1.5)
    assert after.own(TetwildSettings) == before.own(TetwildSettings).model_copy(update={"envelope": 0.02})
    assert after.deviation == before.deviation
    assert TetmeshSettings(engine="lattice").scaled(0.5).edge == 0.3


def test_a_table_of_the_wrong_kind_is_a_bug() -> None:
    with pytest.raises(TypeError, match="lattice has LatticeSettings, not TetwildSettings"):
        TetmeshSettings(engine="lattice").own(TetwildSettings)


def test_every_engine_says_what_it_is_and_the_default_is_one() -> None:
    assert DEFAULT in ENGINES
    description = TetmeshSettings.model_fields["engine"].description or ""
    assert all(engine.meaning in description for engine in ENGINES.values())


def test_the_lattice_ends_at_its_limit_of_time_and_says_how_to_raise_it() -> None:
    smoke = case("tetmesh.lattice.time_limit=1 us")
    domain = enclose(unite(generate(smoke.mat), smoke.surface), smoke.enclosure)
    with pytest.raises(StageError, match=r"after 1e-06 s, the limit, while .*raise tetmesh\.lattice\.time_limit"):
        fill(domain, smoke.tetmesh)
