import numpy as np
import pytest
from bin_assignments import enumerated, random_costs, worked
from draws import draws
from scipy.optimize import linear_sum_assignment

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER, Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.generating import generate
from waybound.solvers.engines.auctions.assignment_steps import auction as auctions, auction_kernels as kernels
from waybound.solvers.engines.auctions.assignment_steps.auction import auction
from waybound.solvers.engines.auctions.assignment_steps.auction_kernels import sparse_phase
from waybound.solvers.engines.auctions.assignment_steps.sides import sides


@pytest.mark.parametrize("few", [auctions.FEW, 0])
def test_random_assignments_are_optimal_and_proved(few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(auctions, "FEW", few)  # 0: always with scaling, and columns that are left over are made cheap again
    rng = np.random.default_rng(1)
    for _ in range(draws(200)):
        costs = random_costs(rng, 5)
        problem = BinAssignment.from_matrix(costs)
        most, best, _ = enumerated(costs)
        found = auction(problem, NEVER)
        judged = problem.evaluate(found.answer)
        assert found.complete and judged.feasible and judged.quantities["pairs"] == most
        assert judged.values[0] == pytest.approx(best, abs=1e-9) == found.evidence(problem, "x").value
        if found.exact and (costs[np.isfinite(costs)] % 1 == 0).all():
            assert found.evidence(problem, "x").value == best


@pytest.mark.parametrize("costs", ["whole", "uniform", "euclidean"])
@pytest.mark.parametrize(("n", "m"), [(80, 80), (60, 90), (90, 60)])
def test_larger_ones_agree_with_shortest_augmenting_paths(costs: str, n: int, m: int) -> None:
    problem = BinAssignment(generate("assignment", 4, robots=n, bins=m, costs=costs))
    found = auction(problem, NEVER)
    matrix = problem.matrix()
    best = matrix[linear_sum_assignment(matrix)].sum()
    assert problem.evaluate(found.answer).values[0] == pytest.approx(best, rel=1e-12)
    assert found.evidence(problem, "x").value == pytest.approx(best, rel=1e-10)
    assert found.looks <= found.bids


@pytest.mark.parametrize("largest", [2, 1000])
def test_rows_remember_their_cheapest_pairs_line_by_line(largest: int) -> None:
    """Rows of 1 pair, of less than a line, of some lines and of more than they remember; many ties."""
    rng = np.random.default_rng(largest)
    for lines in (kernels.LINES, kernels.LINES_SPARSE):
        memory = auctions.remembered(7, lines)
        assert memory.shape == (7, lines, 8) and not memory.ctypes.data % 64 and (memory[:, 0, 0] == -1).all()
    for _ in range(draws(60)):
        n = 40
        m = n + int(rng.integers(0, 2)) * int(rng.integers(1, 20))
        allowed = rng.random((n, m)) < rng.choice([0.02, 0.2, 0.9], (n, 1), p=[0.2, 0.2, 0.6])
        allowed[np.arange(n), rng.permutation(m)[:n]] = True
        assert allowed.sum() > kernels.MANY_PAIRS * n
        costs = np.where(allowed, rng.integers(0, largest + 1, (n, m)), np.inf)
        problem = BinAssignment.from_matrix(costs)
        found = auction(problem, NEVER)
        best = costs[linear_sum_assignment(np.where(allowed, costs, 1e7))].sum()
        assert problem.evaluate(found.answer).values[0] == best == found.evidence(problem, "x").value
        assert found.looks < found.bids


@pytest.mark.parametrize("kind", ["uniform", "ties", "tiny beside large"])
def test_all_pairs_are_counted_only_where_they_are_near(kind: str) -> None:
    """Costs as they are, and the same ones counted beforehand beside a pair that is forbidden: of both the optimum is proved."""
    rng = np.random.default_rng(3)
    for _ in range(draws(30)):
        n = int(rng.integers(25, 60))
        m = n + int(rng.integers(0, 20))
        drawn = {"uniform": rng.random((n, m)) - 0.5, "ties": rng.integers(-2, 3, (n, m)), "tiny beside large": rng.lognormal(0, 6, (n, m))}
        costs = np.asarray(drawn[kind], dtype=float)
        apart = np.full((n, m + 1), np.inf)
        apart[:, :m] = costs
        found, other = (auction(BinAssignment.from_matrix(some), NEVER) for some in (costs, apart))
        problem = BinAssignment.from_matrix(costs)
        values = [problem.evaluate(some.answer).values[0] for some in (found, other)]
        largest = float(np.abs(costs).max())
        assert values[0] == pytest.approx(values[1], abs=1e-9 * largest)
        assert verified_bound(problem, found.evidence(problem, "x")) == pytest.approx(values[0], abs=1e-9 * largest)


def test_bad_prices_to_begin_with_are_repaired_where_columns_are_left_over() -> None:
    """One robot, bins at 5 and 3 whose prices begin at 0 and 10: without repair it takes the first, 2 above the optimum."""
    (part,) = sides(BinAssignment.from_matrix([[5.0, 3.0]]))
    cost, unit, _ = auctions.whole_costs(part, 40, finest=True)
    price, owner = np.array([0, round(10 * unit)]), np.full(2, -1)
    epsilon, counts = round(0.1 * unit), np.zeros(2, np.int64)
    bid = lambda: sparse_phase(NEVER.flag, part.indptr, part.columns, cost, price, owner, epsilon, 0, 1 << 60, counts)  # noqa: E731
    assert bid() == 0 and owner.tolist() == [0, -1]
    while auctions._outbid(price, owner, epsilon):
        bid()
    assert owner.tolist() == [-1, 0]


def test_costs_are_counted_exactly_where_they_can_be() -> None:
    for costs, exact in (
        ([[1.0, 2.0]], True),
        ([[0.25, 2.0**-20]], True),
        ([[1e-18, 1.0]], False),
        ([[1e150, 1.0]], False),
        ([[0.0, 0.0]], True),
    ):
        (part,) = sides(BinAssignment.from_matrix(costs))
        counted, unit, said = auctions.whole_costs(part, auctions.BITS)
        assert said is exact and (counted % 3 == 0).all()
        assert np.ptp(counted) / unit == pytest.approx(np.ptp(costs), rel=1e-12)


@pytest.mark.parametrize("costs", [[[2e-200, 1e-200, 1e150]], [[1e-300, 2e-300], [3e-300, 1e-300]], [[5e-324, 0.0]]])
def test_costs_that_vanish_beside_others_or_below_the_finest_step_are_not_counted_exactly(costs: list[list[float]]) -> None:
    for finest in (False, True):
        (part,) = sides(BinAssignment.from_matrix(costs))
        _, unit, exact = auctions.whole_costs(part, auctions.BITS, finest=finest)
        assert not exact and 0.0 < unit < np.inf


def test_it_ends_when_it_is_asked_to() -> None:
    stop = Stop()
    stop.ask()
    assert not auction(worked("K4"), stop).complete
