# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pipeline.geometry.parts import largest_part, parts


@pytest.mark.parametrize("links", [0, 5, 80, 150, 400])
def test_parts_are_those_that_scipy_finds(links: int) -> None:
    # from things that hardly hang together to one part, about 0.5 links for each being where large parts begin
    for seed in range(20):
        first, second = np.random.default_rng((seed, links)).integers(0, 200, (2, links))
        graph = coo_array((np.ones(links), (first, second)), shape=(200, 200))
        number, part = connected_components(graph, directed=False)
        found, ours = parts(first, second, 200)
        assert found == number
        # numbered by their first thing, as scipy does
        np.testing.assert_array_equal(ours, part)


def test_a_long_chain_is_one_part_whatever_the_order_of_its_links() -> None:
    order = np.random.default_rng(1).permutation(99_999)
    number, part = parts(order + 1, order, 100_000)
    assert number == 1
    assert not part.any()


def test_the_largest_part_is_looked_for_among_what_is_there() -> None:
    # without thing 2 the chain of five falls apart into two and two, of which the first counts
    first, second = np.arange(4), np.arange(1, 5)
    assert largest_part(first, second, np.arange(5) != 2).tolist() == [True, True, False, False, False]
    assert largest_part(first, second, np.arange(5) != 1).tolist() == [False, False, True, True, True]
