from typing import Any

import numpy as np
import pytest
from patience import HANG
from small_routing import plane, small

from waybound.formulations.stop import Stop
from waybound.solvers.bounds.routing.branch_price_cut import Tree
from waybound.solvers.bounds.routing.column_generation import ColumnGeneration, Part
from waybound.solvers.bounds.routing.memory_shares import KEPT, MB, MemoryShares, least_limit
from waybound.solvers.bounds.routing.pricing import MEETING
from waybound.solvers.bounds.routing.set_partition import set_partition
from waybound.solvers.bounds.routing.subset_rows import SubsetRow


def prepared(feature: str, limit: float | None) -> ColumnGeneration:
    problem = small(feature, 1, "exact") if feature else plane(3, 20, 40.0)
    partition = set_partition(problem)
    assert partition is not None
    return ColumnGeneration(problem, partition, Stop(HANG), lambda bound: False, 1, {"memory_limit": limit})


def arrays(columns: ColumnGeneration) -> tuple[int, int]:
    """Bytes of the arrays that grow with the labels, as they are allotted, and of all others of the searches."""
    growing = others = 0
    for end in (end for pricer in columns.pricers for end in pricer.ends):
        lists = [part for part in vars(end).values() if isinstance(part, np.ndarray)]
        large = [part for part in lists if len(part) >= min(len(end.node), len(end.rows) - 1)]
        growing += sum(part.nbytes for part in large) + MEETING * (len(end.rows) - 1)
        others += sum(part.nbytes for part in lists) - sum(part.nbytes for part in large)
    return growing, others


@pytest.mark.parametrize("feature", ["", "heterogeneous-fleet"])
@pytest.mark.parametrize("limit", [275, 400, 800])
@pytest.mark.parametrize("cuts", [0, 30, 130, 500])
def test_arrays_of_labels_are_no_larger_than_their_share(feature: str, limit: int, cuts: int) -> None:
    columns = prepared(feature, limit)
    n = len(columns.partition.row)
    memory = np.ones(n, dtype=bool)
    for pricer, usable in zip(columns.pricers, columns.usable, strict=True):
        pricer.restrict(usable, columns.near, [SubsetRow((1, 2, 3), memory) for _ in range(cuts)])
    growing, others = arrays(columns)
    assert 0.4 * columns.shares.labels < growing <= columns.shares.labels + 10_000
    assert columns.shares.labels + columns.shares.routes + columns.shares.tree + KEPT + others <= limit * MB


def test_without_a_limit_there_is_room_for_the_usual_number() -> None:
    columns = prepared("", None)
    assert columns.shares == MemoryShares() and {len(end.node) for end in columns.pricers[0].ends} == {2_000_000}


def test_dear_routes_are_dropped_at_half_their_share_and_too_many_end_the_search() -> None:
    usual = prepared("", None)
    part = Part(usual.cost, usual.partition.fewest, usual.partition.most, usual.partition.optional)
    whole = usual.solve(part, None)
    small_share, smallest = prepared("", None), prepared("", None)
    small_share.shares = MemoryShares(routes=usual.pool.bytes)
    solved = small_share.solve(part, None)
    assert solved.status == "done" and solved.bound == pytest.approx(whole.bound) and len(small_share.pool) < len(usual.pool)
    smallest.shares = MemoryShares(routes=1000.0)
    assert smallest.solve(part, None).status == "full" and smallest.limit == "memory"


def test_a_tree_that_holds_too_much_is_handed_over() -> None:
    problem = plane(3, 14, 30.0)
    partition = set_partition(problem)
    assert partition is not None
    tree: Any = Tree(problem, partition, None, Stop(HANG), 1)
    assert not tree.full
    tree.columns.shares, tree.numbers = MemoryShares(tree=1000.0), 21
    assert tree.full and tree.columns.limit == "memory"


def test_the_least_limit_grows_with_the_problem() -> None:
    assert least_limit(10, 1) < least_limit(400, 1) < least_limit(400, 5)
    assert MemoryShares.of(least_limit(400, 5), 400, 5).labels >= 10 * MB
