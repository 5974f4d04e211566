import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound.formulations.routing.checking import walk_networks, walks
from waybound.formulations.routing.checking.relaxation import Resource
from waybound.formulations.routing.checking.walk_networks import BITS, FAR, Row
from waybound.formulations.routing.checking.walks import Load, Multipliers, Walks
from waybound.formulations.stop import NEVER, Stop

SEEDS = st.integers(0, 10**6)


@dataclass(frozen=True, eq=False)
class Case:
    """Numbers that doubles hold: multiples of 1/8."""

    cost: np.ndarray
    resources: list[Resource]
    multipliers: Multipliers
    needed: list[np.ndarray]

    def walks(self, **limits: int) -> Walks:
        limits = {"room": 100_000, "work": 10**8} | limits
        return Walks(self.cost, self.resources, self.multipliers, self.needed, NEVER, **limits)

    def least(self, which: int | None = None, claimed: float | None = None) -> Fraction | None:
        """The least that labels find, as a number."""
        made = self.walks()
        found = made.least(which, claimed)
        assert found is not None
        return None if found == FAR else Fraction(found) / Fraction(2) ** made.exponent

    @property
    def customers(self) -> int:
        return len(self.cost) - 1


def case(seed: int, customers: int | None = None) -> Case:
    """Random moves, levels, memories, rows and loads."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 5)) if customers is None else customers

    def eighths(low: int, high: int, *shape: int) -> np.ndarray:
        return rng.integers(8 * low, 8 * high, shape) / 8.0

    cost = np.where(rng.random((n + 1, n + 1)) < 0.85, eighths(0, 10, n + 1, n + 1), math.inf)
    np.fill_diagonal(cost, math.inf)
    resources = []
    for _ in range(int(rng.integers(1, 3))):
        weight = eighths(1, 5, n + 1, n + 1) * (rng.random((n + 1, n + 1)) < rng.choice([0.5, 0.9, 1.0, 1.0]))
        lower = np.append(0.0, eighths(0, 6, n)) if rng.random() < 0.5 else np.zeros(n + 1)
        upper = np.append(eighths(8, 16), lower[1:] + eighths(3, 12, n))
        resources.append(Resource(weight, 0.0, lower, upper, 0.0, 100.0))
    if rng.random() < 0.4:  # the first level is never below a further one
        below = replace(resources[0], weight=eighths(0, 5, n + 1, n + 1))
        resources = [replace(resources[0], above=below), *resources[1:], below]
    rows = []
    for _ in range(int(rng.integers(0, 4)) if n >= 3 else 0):
        sites = rng.choice(n, 3, replace=False) + 1
        memory = np.union1d(sites, rng.choice(n, int(rng.integers(0, n + 1)), replace=False) + 1)
        rows.append(Row(sites, memory, -float(eighths(0, 6))))
    loads = []
    for _ in range(int(rng.integers(0, 3))):
        loads.append(Load(rng.choice(n, int(rng.integers(1, n + 1)), replace=False) + 1, int(rng.integers(1, 4)), float(eighths(0, 5))))
    listed = np.full((n + 1, n), -1, np.int32)
    for j in range(1, n + 1):
        others = [k for k in range(1, n + 1) if k != j and rng.random() < 0.5]
        listed[j, : len(others)] = others
    needed = [rng.random((n + 1, n + 1)) < 0.3 for _ in range(int(rng.integers(0, 3)))]
    return Case(cost, resources, Multipliers(eighths(-2, 12, n), loads, rows, listed), needed)


def raised(given: Case, levels: list[float]) -> list[float]:
    """Levels, those raised that are never below another one."""
    partner = [next((k for k, other in enumerate(given.resources) if other is r.above), r_at) for r_at, r in enumerate(given.resources)]
    return [max(level, levels[k]) for level, k in zip(levels, partner, strict=True)]


def every_walk(given: Case) -> Iterator[list[int]]:
    """Customers of all walks of at most as many visits as there are customers, one more visit at a time."""
    listed = [{j, *(k for k in row.tolist() if k >= 0)} for j, row in enumerate(given.multipliers.listed)]

    def further(walk: list[int], levels: list[float], memory: set[int]) -> Iterator[list[int]]:
        tail = walk[-1] if walk else 0
        last = raised(given, [v + r.weight[tail, 0] for v, r in zip(levels, given.resources, strict=True)])
        back = all(v <= r.upper[0] for v, r in zip(last, given.resources, strict=True))
        if walk and back and math.isfinite(given.cost[tail, 0]):
            yield walk
        for head in range(1, given.customers + 1) if len(walk) < given.customers else ():
            if head in memory or not math.isfinite(given.cost[tail, head]):
                continue
            after = [max(r.lower[head], v + r.weight[tail, head]) for v, r in zip(levels, given.resources, strict=True)]
            after = raised(given, after)
            if all(v <= r.upper[head] for v, r in zip(after, given.resources, strict=True)):
                yield from further([*walk, head], after, (memory & listed[head]) | {head})

    return further([], [r.start for r in given.resources], set())


def reduced_cost(given: Case, walk: list[int]) -> Fraction:
    """As it is defined: the cost less what the rows that the walk is in are worth."""
    many = given.multipliers
    moves = list(itertools.pairwise([0, *walk, 0]))
    total = sum((Fraction(float(given.cost[i, j])) for i, j in moves), Fraction(0)) - sum(Fraction(many.visits[j - 1]) for j in walk)
    for load in many.loads:
        total -= sum(i not in load.sites and j in load.sites for i, j in moves) * Fraction(load.price)
    for row in many.rows:
        half, times = False, 0
        for j in walk:
            half = half and j in row.memory
            if j in row.sites:
                half, times = not half, times + half
        total -= times * Fraction(row.price)
    return total


def makes(walk: list[int], needed: np.ndarray) -> bool:
    return any(needed[i, j] for i, j in itertools.pairwise([0, *walk, 0]))


@settings(max_examples=draws(400), deadline=None)
@given(seed=SEEDS)
def test_labels_find_the_least_of_all_walks(seed: int) -> None:
    given_case = case(seed)
    found = {tuple(walk): reduced_cost(given_case, walk) for walk in every_walk(given_case)}
    least = min(found.values(), default=None)
    assert given_case.least() == least
    for which, needed in enumerate(given_case.needed):
        through = [cost for walk, cost in found.items() if makes(list(walk), needed & np.isfinite(given_case.cost))]
        assert given_case.least(which) == min(through, default=None)


@settings(max_examples=draws(200), deadline=None)
@given(seed=SEEDS, claimed=st.integers(-160, 80))
def test_what_is_claimed_is_found_where_it_is_true_and_the_least_where_it_is_not(seed: int, claimed: int) -> None:
    given_case = case(seed)
    found = [(walk, reduced_cost(given_case, walk)) for walk in every_walk(given_case)]
    most = Fraction(FAR) / Fraction(2) ** given_case.walks().exponent  # beyond what any walk costs
    claim = Fraction(claimed, 8)
    bounded = [max(claim, -most)] if claim < most else []
    assert given_case.least(claimed=float(claim)) == min([*bounded, *(cost for _, cost in found)], default=None)
    for which, needed in enumerate(given_case.needed):
        through = [cost for walk, cost in found if makes(walk, needed)]
        assert given_case.least(which, float(claim)) == min([*bounded, *through], default=None)


@settings(max_examples=draws(60), deadline=None)
@given(seed=SEEDS, cells=st.sampled_from([1, 2, 7]), longest=st.sampled_from([0, 3]))
def test_neither_cells_nor_counted_visits_change_what_is_found(seed: int, cells: int, longest: int) -> None:
    given_case = case(seed)
    least = given_case.least()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(walk_networks, "CELLS", cells)
        patch.setattr(walk_networks, "LONGEST", longest)
        assert given_case.least() == least


@settings(max_examples=draws(100), deadline=None)
@given(seed=SEEDS, few=st.sampled_from([0, 1, 6]), cells=st.sampled_from([3, 256]))
def test_walks_that_go_backwards_first_change_nothing(seed: int, few: int, cells: int) -> None:
    given_case = case(seed)
    kinds = [None, *range(len(given_case.needed))]
    least = [given_case.least(which) for which in kinds]
    with pytest.MonkeyPatch.context() as patch:
        for module, name, value in ((walks, "QUICK", -1), (walks, "FEW", few), (walk_networks, "CELLS", cells)):
            patch.setattr(module, name, value)
        assert [given_case.least(which) for which in kinds] == least


def test_after_walks_that_go_backwards_fewer_labels_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    n, rng = 60, np.random.default_rng(1)
    xy = rng.uniform(0.0, 100.0, (n + 1, 2))
    cost = np.hypot(*(xy[:, None] - xy[None, :]).transpose(2, 0, 1))
    np.fill_diagonal(cost, math.inf)
    load = Resource(np.tile(np.append(0.0, rng.integers(1, 9, n)), (n + 1, 1)), 0.0, np.zeros(n + 1), np.full(n + 1, 60.0), 0.0, 99.0)
    near = np.argsort(cost[1:, 1:], axis=1)[:, :10] + 1
    listed = np.vstack([np.full((1, 10), -1), near]).astype(np.int32)
    given_case = Case(cost, [load], Multipliers(np.full(n, 16.0), [], [], listed), [])
    found, work = [], [[10**8]]
    for _ in range(2):
        monkeypatch.setattr(walks, "QUICK", work[-1][0])  # enough for a first walk
        one = given_case.walks()
        run, steps = one._run, list[int]()

        def counted(*given, one=one, run=run, steps=steps, **more):
            before = one.work
            result = run(*given, **more)
            steps.append(before - one.work)
            return result

        monkeypatch.setattr(one, "_run", counted)
        found.append(one.least())
        work.append(steps)
    assert found[0] == found[1] and [len(steps) for steps in work[1:]] == [2, 4]
    assert work[2][-1] < work[1][-1] / 2


def test_the_constant_is_what_all_rows_are_worth() -> None:
    given_case = case(3, 4)
    many = replace(
        given_case.multipliers,
        loads=[Load(np.array([1, 2]), 3, 0.5)],
        rows=[Row(np.array([1, 2, 3]), np.array([1, 2, 3, 4]), -1.25)],
    )
    made = replace(given_case, multipliers=many).walks()
    assert Fraction(made.constant) / Fraction(2) ** made.exponent == Fraction(float(many.visits.sum()) + 3 * 0.5 - 1.25)


@pytest.mark.parametrize("customers", [BITS - 2, BITS - 1, BITS, 2 * BITS])
def test_memories_and_rows_of_several_words(customers: int) -> None:
    """All on a line, each once, at prices that pay for any visit: the walk of all of them, less its halves of rows."""
    n = customers
    cost = np.ones((n + 1, n + 1))
    np.fill_diagonal(cost, math.inf)
    order = Resource(np.ones((n + 1, n + 1)), 0.0, np.zeros(n + 1), np.full(n + 1, n + 1.0), 0.0, 4.0 * n)
    others = np.array([[k for k in range(1, n + 1) if k != j] for j in range(1, n + 1)])
    listed = np.vstack([np.full((1, n - 1), -1), others]).astype(np.int32)
    # The moves from k to k + 1, and home, are all that is left.
    chain = np.full_like(cost, math.inf)
    chain[np.arange(n), np.arange(1, n + 1)] = 1.0
    chain[1:, 0] = 1.0
    rows = [Row(np.array([k, k + 1, k + 2]), np.arange(1, n + 1), -0.25) for k in range(1, n - 1)]
    made = Case(chain, [order], Multipliers(np.full(n, 2.0), [], rows, listed), [])
    assert made.least() == (n + 1) - 2 * n + len(rows) * Fraction(1, 4)
    free = Case(np.where(np.isfinite(cost), 1.0, math.inf), [order], Multipliers(np.full(n, -1.0), [], rows, listed), [])
    assert free.least() == 3


def test_numbers_are_no_finer_than_is_asked_for() -> None:
    given_case = case(3, 4)
    own = given_case.walks()
    coarse, fine = given_case.walks(finest=5), given_case.walks(finest=own.exponent + 1)
    assert (coarse.exponent, fine.exponent) == (5, own.exponent) and own.exponent > 5
    assert (coarse.visits == np.ldexp(given_case.multipliers.visits, 5)).all()
    found, least = coarse.least(), given_case.least()
    assert found is not None and least is not None and Fraction(found, 32) == least  # all are eighths


def test_it_gives_up_at_its_limits_and_when_it_is_asked_to() -> None:
    given_case = case(5, 4)
    assert given_case.walks(work=0).least() is None
    assert given_case.walks(room=1).least() is None
    stopped = Walks(given_case.cost, given_case.resources, given_case.multipliers, [], Stop(0.0), 1000, 10**6)
    assert stopped.least() is None


def test_numbers_that_cannot_be_added_up_are_refused() -> None:
    given_case = case(5, 3)
    large = replace(given_case.multipliers, visits=np.full(3, 1e308))
    with pytest.raises(OverflowError):
        replace(given_case, multipliers=large).walks()
    down = replace(given_case.resources[0], weight=-given_case.resources[0].weight)
    with pytest.raises(OverflowError):
        replace(given_case, resources=[down]).walks()
