"""Conflict auction: worked epochs, the facts that are proved of it, and its worst lines."""

import math

import numpy as np
import pytest
from bin_assignments import OPTIMA, random_costs, worked
from draws import draws

import waybound as wb
from waybound import BinAssignment
from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.auctions.conflict_auction import completed, greedy_ratio, quadrangle
from waybound.heuristics.heuristic import HEURISTICS, Context
from waybound.instances.generating import generate
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.reports.studies.auctions.bin_auctions import greedy_line, serial_line
from waybound.solvers.linear_programs import linear_programs

CASES = {
    "A": (9, (0, 1, 2), 1, 3), "F": (9, (0, 2), 2, 3), "E": (7, (-1, 0, 1), 2, 5), "G": (3, (0, 1), 2, 3), "O": (6, (0, 1), 2, 3),
    "B": (100, (0, 1), 2, 3), "D": (10, (0, 1, 2), 3, 5), "K4": (39, (1, 0, 2, 3), 4, 9), "L3": (201, (0, 1, 2), 3, 5),
}  # fmt: skip
IMMEDIATE = {"A": 9, "F": 9, "E": 7, "G": 3, "O": 6, "B": 100, "D": 15, "K4": 39, "L3": 521}


def run(problem: BinAssignment, **options):
    return run_heuristic(problem, "auction", options, 1)


def value(problem: BinAssignment, **options) -> float:
    return float(problem.evaluate(run(problem, **options).answer).values[0])


@pytest.mark.parametrize("name", CASES)
def test_worked_epochs(name: str) -> None:
    problem, (cost, plan, rounds, bids) = worked(name), CASES[name]
    found = run(problem)
    assert problem.evaluate(found.answer).values == (cost,) and found.answer == plan
    assert found.statistics == {"rounds": rounds, "bids": bids}
    assert value(problem, mode="immediate") == IMMEDIATE[name] and cost >= OPTIMA[name]


def cheapest_pairs_first(costs: np.ndarray) -> list[int]:
    taken, used = [-1] * len(costs), set()
    for _, i, j in sorted((c, i, j) for (i, j), c in np.ndenumerate(costs) if math.isfinite(c)):
        if taken[i] < 0 and j not in used:
            taken[i] = j
            used.add(j)
    return taken


def test_it_is_the_cheapest_pair_again_and_again_and_nobody_would_rather_change() -> None:
    rng = np.random.default_rng(21)
    for _ in range(draws(300)):
        n, m = rng.integers(1, 8, 2)
        costs = rng.integers(0, 6, (n, m)).astype(float) if rng.random() < 0.5 else rng.random((n, m))
        found = run(BinAssignment.from_matrix(costs))
        assert list(found.answer) == cheapest_pairs_first(costs)
        holder = {j: i for i, j in enumerate(found.answer) if j >= 0}
        assert len(holder) == min(n, m)
        own = [costs[i, j] if j >= 0 else math.inf for i, j in enumerate(found.answer)]
        assert not any(costs[i, j] < own[i] and (j not in holder or costs[i, j] < own[holder[j]]) for i in range(n) for j in range(m))
        bids, rounds = found.statistics["bids"], found.statistics["rounds"]
        assert bids <= (n * (n + 1) // 2 if m >= n else m * (m + 1) // 2 + (n - m) * m)
        assert m < n or rounds <= 1 + n * (n - 1) // 2


def test_robots_in_one_place_are_served_at_the_optimum_and_no_answer_beats_the_least_of_each_row() -> None:
    rng = np.random.default_rng(22)
    for _ in range(draws(60)):
        n = int(rng.integers(1, 6))
        costs = rng.integers(0, 9, (n, 1)) + rng.integers(0, 9, (1, int(rng.integers(n, 8)))).astype(float)
        problem = BinAssignment.from_matrix(costs)
        assert value(problem) == run_optimum(problem) >= costs.min(axis=1).sum()


def run_optimum(problem: BinAssignment) -> float:
    return float(problem.evaluate(run_heuristic(problem, "bertsekas", {}, 1).answer).values[0])


def test_a_constant_in_a_row_changes_what_it_does() -> None:
    problem = BinAssignment.from_matrix([[11.0, 12.0], [2.0, 5.0]])
    assert run(problem).answer == (1, 0) and value(problem) == 14.0 == run_optimum(problem)


def test_its_ratio_is_attained_on_a_line_in_as_many_rounds_as_robots() -> None:
    ratios = [1.0, 2.0, 3.5, 5.75, 9.125, 14.1875]
    for doublings, ratio in enumerate(ratios):
        case = greedy_line(doublings)
        assert case.optimum is not None and case.optimum.value == pytest.approx(2**doublings) == pytest.approx(run_optimum(case.problem))
        found = run(case.problem)
        assert greedy_ratio(2**doublings) == pytest.approx(ratio, rel=1e-12)
        assert case.problem.evaluate(found.answer).values[0] / case.optimum.value == pytest.approx(ratio, rel=1e-9)
        assert found.guarantee is not None and found.guarantee.ratio == greedy_ratio(2**doublings)
        assert found.statistics["rounds"] == 2**doublings
    assert [value(greedy_line(k, 1e-7).problem) for k in range(6)] == pytest.approx([1, 4, 14, 46, 146, 454], rel=1e-5)
    assert all(value(serial_line(n).problem) == 1.0 for n in range(1, 9))


def test_the_guarantee_is_given_on_costs_of_travel_only_and_only_where_bids_are_deferred() -> None:
    line = worked("L3")
    assert run(line).guarantee is not None and run(line, mode="immediate").guarantee is None
    assert value(line, mode="immediate") / OPTIMA["L3"] > greedy_ratio(3)
    assert run(worked("B")).guarantee is None
    assert run(BinAssignment.from_matrix([[1.0, math.inf], [1.0, 2.0]])).guarantee is None
    assert run(BinAssignment(generate("assignment", 3, costs="orchard", robots=9, bins=4))).guarantee is not None
    found = wb.solve(worked("B"), heuristic="auction")
    assert "guarantees nothing for this instance" in found.message and found.bound == 2.0


def test_pairs_are_put_in_order_block_by_block(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = BinAssignment(generate("assignment", 5, robots=7, bins=9, arcs=4))
    whole = run(problem).answer
    monkeypatch.setattr("waybound.heuristics.auctions.conflict_auction.BLOCK", 5)
    assert run(problem).answer == whole


def test_pairs_that_it_leaves_out_are_made_and_said() -> None:
    found = run(BinAssignment.from_matrix([[1.0, 9.0], [2.0, math.inf]]))
    assert found.answer == (1, 0) and found.statistics["changed"] == 2 and "other bins for 2 robots" in found.message


def test_average_ratios_are_those_of_simulation() -> None:
    """Ratios of the deferred and the immediate auction and of the serial order, and how often the first is the optimum."""
    rng = np.random.default_rng(31)
    known = {2: (1.065, 1.065, 1.113, 0.82), 3: (1.121, 1.125, 1.177, 0.64), 5: (1.209, 1.213, 1.304, 0.31),
             10: (1.392, 1.402, 1.522, 0.04), 20: (1.639, 1.648, 1.798, 0.001)}  # fmt: skip
    for n, means in known.items():
        seen = []
        for _ in range(draws(500) if n < 20 else draws(150)):
            problem = BinAssignment.from_matrix(rng.random((n, n)))
            best, deferred = run_optimum(problem), value(problem)
            made = [deferred, value(problem, mode="immediate"), serial_value(problem)]
            seen.append([*(cost / best for cost in made), float(deferred <= best * (1 + 1e-9))])
        spread = np.maximum(np.std(seen, axis=0), 0.05)
        assert (np.abs(np.mean(seen, axis=0) - means) <= 4.0 * spread / math.sqrt(len(seen))).all()


def test_average_ratios_in_an_orchard_of_five_lanes_are_those_of_simulation() -> None:
    """Four robots and bins; to 0.02, as the simulation's draws of what is filled are not known, and four deviations of the mean."""
    seen = []
    for seed in range(draws(400)):
        problem = BinAssignment(generate("assignment", seed, costs="orchard", robots=4, bins=4, rows=5, columns=10))
        best = run_optimum(problem)
        deferred, immediate = value(problem), value(problem, mode="immediate")
        if best > 0:
            seen.append([deferred / best, immediate / best, serial_value(problem) / best, deferred == best, immediate == best])
    spread = np.std(seen, axis=0) / math.sqrt(len(seen))
    assert (np.abs(np.mean(seen, axis=0) - (1.038, 1.040, 1.112, 0.72, 0.71)) <= 0.02 + 4.0 * spread).all()


def serial_value(problem: BinAssignment) -> float:
    return float(problem.evaluate(run_heuristic(problem, "online-greedy", {}, 1).answer).values[0])


def test_the_quadrangle_inequality_is_told_from_all_four_corners() -> None:
    rng = np.random.default_rng(51)
    seen = set()
    for _ in range(draws(150)):
        n, m = rng.integers(1, 5, 2)
        costs = rng.integers(1, 8, (n, m)).astype(float)
        i, k, j, l = np.ix_(range(n), range(n), range(m), range(m))  # noqa: E741
        holds = bool((costs[i, j] <= costs[i, l] + costs[k, l] + costs[k, j]).all())
        assert quadrangle(BinAssignment.from_matrix(costs), NEVER) is holds
        seen.add(holds)
    assert seen == {True, False}


def test_points_of_a_line_keep_it_in_spite_of_rounding() -> None:
    points = np.cumsum(np.full(12, 0.1))
    assert quadrangle(BinAssignment.from_matrix(np.abs(points[::2, None] - points[1::2])), NEVER)


def test_as_many_pairs_as_possible_and_few_changes() -> None:
    rng = np.random.default_rng(52)
    for _ in range(draws(60)):
        problem = BinAssignment.from_matrix(random_costs(rng, 6))
        answer, changed = completed(problem, np.full(problem.num_robots, -1), NEVER)
        assert problem.evaluate(answer).feasible and changed == problem.pairs
        assert completed(problem, np.array(answer), NEVER) == (answer, 0)


@pytest.mark.parametrize("heuristic", ["auction", "bertsekas", "online-greedy"])
def test_who_is_cut_short_hands_over_as_many_pairs_as_there_can_be(heuristic: str) -> None:
    problem, stop = worked("K4"), Stop()
    stop.ask()
    context = Context(np.random.default_rng(1), 10.0, None, lambda answer: None, stop, linear_programs(None, 1, 1))
    found = HEURISTICS[heuristic].run(problem, context)
    assert problem.evaluate(found.answer).feasible and found.guarantee is None and "any of the most pairs" in found.message
    assert found.limit == "interrupt"
