"""Relays: the spanning tree's, the fewest on a graph, and the 1-median, which is another problem."""

import math

import numpy as np
import pytest

from waybound.formulations.stop import Stop, Stopped
from waybound.heuristics.auctions.relay_steps.steiner_points import fermat_weber, fewest_relays, spanning_tree_relays
from waybound.instances.errors import InputError


def polygon(corners):
    angle = 2 * math.pi * np.arange(corners) / corners
    return np.column_stack([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize(
    ("terminals", "reach", "relays"),
    [
        ([(0, 0), (10, 0)], 3, 3), ([(0, 0), (10, 0)], 5, 1), ([(0, 0), (6, 0), (6, 4), (0, 9)], 3, 4), (polygon(3), 1, 2),
        (polygon(5), 1, 4), ([(7, 7)], 1, 0), ([(1, 1), (1, 1)], 1, 0),
    ],
)  # fmt: skip
def test_reference_cases(terminals, reach, relays):
    found = spanning_tree_relays(terminals, reach)
    assert len(found.relays) == relays and found.guarantee.ratio == 4.0


def test_a_strict_reach_needs_one_more_at_its_multiples():
    assert [len(spanning_tree_relays([(0, 0), (10, 0)], reach, strict=True).relays) for reach in (5, 3)] == [2, 3]


@pytest.mark.parametrize("strict", [False, True])
def test_links_are_short_enough_and_join_everything(strict):
    rng = np.random.default_rng(1)
    for _ in range(50):
        terminals, reach = rng.random((int(rng.integers(1, 8)), 2)), float(rng.uniform(0.05, 1))
        found = spanning_tree_relays(terminals, reach, strict=strict)
        nodes = np.vstack([terminals, found.relays])
        assert len(found.links) == len(nodes) - 1
        ends = nodes[found.links]
        assert (np.hypot(*(ends[:, 0] - ends[:, 1]).T) <= reach * (1 + 2e-9)).all()
        reached = {0}
        for _ in nodes:
            reached |= {int(b) for a, b in (*found.links, *found.links[:, ::-1]) if int(a) in reached}
        assert len(reached) == len(nodes)


def test_the_ratio_of_4_is_attained_by_a_pentagon_and_never_passed_on_graphs_of_sites():
    sites = np.vstack([polygon(5), [(0, 0)]])
    linked = np.hypot(*(sites[:, None] - sites).transpose(2, 0, 1)) <= 1 + 1e-9
    assert fewest_relays(linked, range(5)) == (5,)
    rng = np.random.default_rng(2)
    for _ in range(20):  # the fewest among given sites are no fewer than the fewest anywhere
        sites, reach = rng.random((9, 2)), 0.4
        linked = np.hypot(*(sites[:, None] - sites).transpose(2, 0, 1)) <= reach
        fewest = fewest_relays(linked, [0, 1, 2])
        if fewest is not None:
            assert len(spanning_tree_relays(sites[:3], reach).relays) <= 4 * len(fewest)


def test_the_fewest_rooms_on_a_path_a_star_and_where_there_is_no_way():
    path = np.abs(np.arange(6)[:, None] - np.arange(6)) == 1
    assert fewest_relays(path, [0, 5]) == (1, 2, 3, 4) and fewest_relays(path, [2, 3]) == () and fewest_relays(path, [4]) == ()
    assert fewest_relays(path, [0, 5], most=3) is None
    assert fewest_relays(np.eye(3, dtype=bool), [0, 2]) is None
    with pytest.raises(Stopped):
        fewest_relays(path, [0, 5], stop=Stop(0.0))


def test_the_1_median():
    corners = np.array([(0, 0), (4, 0), (0, 4)], dtype=float)
    here = fermat_weber(corners)
    assert here.tolist() == pytest.approx([0.845299, 0.845299], abs=1e-6)
    assert np.hypot(*(corners - here).T).sum() == pytest.approx(4 * math.sqrt(2 + math.sqrt(3)), rel=1e-12)
    assert fermat_weber([(0, 0), (9, 9), (1, 0), (0, 1)]).tolist() == pytest.approx([0.5, 0.5])
    assert fermat_weber(corners, [9, 1, 1]).tolist() == pytest.approx([0, 0], abs=1e-9)
    assert fermat_weber([(3, 4)]).tolist() == [3, 4]
    assert fermat_weber([(0, 0), (1, 0), (2, 0)]).tolist() == pytest.approx([1, 0])


def test_it_is_another_problem_than_relays():
    terminals = [(0, 0), (10, 0), (0, 10)]
    assert len(spanning_tree_relays(terminals, 5).relays) == 2
    away = np.hypot(*(np.array(terminals) - fermat_weber(terminals)).T)
    assert away.min() < 5 < away.max()


def test_what_makes_no_sense_is_refused():
    for call in (
        lambda: spanning_tree_relays([], 1), lambda: spanning_tree_relays([(0, np.nan)], 1), lambda: spanning_tree_relays([(0, 0)], 0),
        lambda: fewest_relays([[0, 1], [0, 0]], [0]), lambda: fewest_relays(np.eye(2), [5]), lambda: fermat_weber([]),
        lambda: fermat_weber([(0, 0)], [0]),
    ):  # fmt: skip
        with pytest.raises(InputError):
            call()
