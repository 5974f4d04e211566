"""Branch and bound that is there to prove: the optimum, or that there is no answer, by evidence that a checker takes."""

import json
import math
import time

import numpy as np
import pytest
from branching_programs import hard, knapsack, random_program, without_answer
from draws import draws
from patience import HANG
from programs import program
from truth.families import truth

import waybound as wb
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import certify, check_certificate
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS, branching_tree
from waybound.solvers.bounds.branching_tree import branching_tree_bound


@pytest.mark.share(2)
@pytest.mark.parametrize("seed", range(draws(200)))
def test_optimum_and_infeasibility_of_small_programs_are_proved(seed: int) -> None:
    problem = random_program(seed)
    known = truth(problem)
    evidence = branching_tree_bound(problem, Stop(30.0))
    if not problem.program.is_integer:
        assert evidence is None
        return
    assert evidence is not None
    made = certify(problem, None, [evidence])
    written = json.loads(json.dumps(made.to_json(with_evidence=True), allow_nan=False))
    again = check_certificate(problem, written, None)
    assert again.infeasible == (known.best is None)
    if known.best is not None:
        assert again.bound == pytest.approx(float(known.best[0]), rel=1e-9, abs=1e-9)
        sign = 1.0 if problem.sense == "min" else -1.0
        assert again.bound is not None and sign * again.bound <= sign * float(known.best[0]) + 1e-9


def test_it_ends_where_the_bound_reaches_the_target() -> None:
    problem = hard()
    root = branching_tree_bound(problem, Stop(HANG), target=1e9)
    assert root is not None and root.kind == "lp-dual"
    value = verified_bound(problem, root)
    stop = Stop(HANG)
    some = branching_tree_bound(problem, stop, target=value - 1.0)
    assert not stop.reached()
    assert some is not None and verified_bound(problem, some) <= value


def test_a_whole_point_on_the_way_takes_the_place_of_a_worse_target() -> None:
    evidence = branching_tree_bound(knapsack(), Stop(60.0), target=9.0)
    assert evidence is not None
    assert verified_bound(knapsack(), evidence) == pytest.approx(14.0)


@pytest.mark.share(2)
@pytest.mark.parametrize("seconds", [0.0, 0.01, 0.3, 1.0])
def test_it_stops_in_time_with_the_bound_that_it_has(seconds: float) -> None:
    problem = hard()
    began = time.perf_counter()
    evidence = branching_tree_bound(problem, Stop(seconds))
    assert time.perf_counter() - began < HANG
    if evidence is not None:
        assert verified_bound(problem, evidence) == pytest.approx(evidence.value)


def test_it_stops_when_it_is_asked_to(monkeypatch: pytest.MonkeyPatch) -> None:
    stop = Stop(HANG)
    branch = branching_tree._Tree.branch

    def asked(tree: branching_tree._Tree, node: branching_tree._Node) -> bool:
        stop.ask()
        return branch(tree, node)

    monkeypatch.setattr(branching_tree._Tree, "branch", asked)
    evidence = branching_tree_bound(hard(), stop)
    assert stop.reached() == "interrupt"
    assert evidence is not None


class Counted(branching_tree._Tree):
    """Ends after a number of branchings."""

    left = 0

    def branch(self, node: branching_tree._Node) -> bool:
        self.left -= 1
        if self.left < 0:
            self.stop.ask()
        return self.left >= 0 and super().branch(node)


def test_more_branchings_prove_no_less() -> None:
    problem, values = hard(5), []
    for nodes in (1, 5, 25):
        tree = Counted(problem.compile(), None, Stop(60.0), 1)
        tree.left = nodes
        tree.grow()
        evidence = tree.evidence("a program")
        assert evidence is not None
        values.append(verified_bound(problem, evidence))
        assert values[-1] == pytest.approx(evidence.value)
    assert values == sorted(values, reverse=True) and values[-1] < values[0]


@pytest.mark.parametrize("power", [-200, -40, 40, 200])
def test_a_program_is_proved_alike_in_every_unit(power: int) -> None:
    unit = 2.0**power
    p = program([3.0, 2.0, 1.1 * unit], [[2, 3, 1 * unit], [4, 1, 3 * unit]], -math.inf, [7, 8.5], 0.0, [5, 5, 1.5 / unit], integer=[0, 1],
                sense="max")  # fmt: skip
    evidence = branching_tree_bound(ArrayProblem(p), Stop(60.0))
    best = truth(ArrayProblem(p)).best
    assert evidence is not None and best is not None
    assert verified_bound(ArrayProblem(p), evidence) == pytest.approx(float(best[0]), rel=1e-9)


@pytest.mark.slow
def test_an_engine_that_tells_nonsense_proves_nothing_false(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(1)
    honest = branching_tree.LinearSession.solve

    def lies(self: branching_tree.LinearSession, stop: Stop, iterations: int | None = None) -> branching_tree.LinearResult:
        found = honest(self, stop, iterations)
        if rng.random() < 0.3:
            rows = self._program.num_rows
            told = str(rng.choice(["optimal", "infeasible", "unknown"]))
            x = np.round(rng.normal(size=self._program.num_variables))
            return branching_tree.LinearResult(told, float(rng.normal()), x, rng.normal(size=rows), rng.normal(size=rows))
        return found

    monkeypatch.setattr(branching_tree.LinearSession, "solve", lies)
    for seed in range(60):
        problem = random_program(seed)
        best, sign = truth(problem).best, 1.0 if problem.sense == "min" else -1.0
        evidence = branching_tree_bound(problem, Stop(0.5))
        if evidence is not None and best is not None:
            assert sign * verified_bound(problem, evidence) <= sign * float(best[0]) + 1e-9


def test_where_the_relaxation_is_endless_a_tree_proves_that_there_is_no_answer() -> None:
    endless = ArrayProblem(program([1, 1, -1], [[2, 2, 0]], [3], [3], 0.0, [1, 1, math.inf], integer=[0, 1]))
    found = branching_tree_bound(endless, Stop(20.0))
    assert found is not None and found.kind == "branching-tree"
    assert verified_bound(endless, found) == math.inf


def test_programs_that_no_tree_can_prove_are_left_alone() -> None:
    assert branching_tree_bound(ArrayProblem(program([1, 1], [[1, 1]], 1, 2)), Stop(60.0)) is None
    squared = program([1.0], [[1]], 1, 2, integer=[0], quadratic=[[1.0]])
    assert branching_tree_bound(ArrayProblem(squared), Stop(60.0)) is None
    assert branching_tree_bound(knapsack(), Stop(0.0)) is None
    fractional = wb.generate("sata", problem="bottleneck-lp", robots=4, actions=2, targets=5, phi=40)
    assert BOUNDS["branching-tree"].missing(fractional)


def test_solve_shows_an_optimum_as_proved_and_an_infeasible_program_as_that() -> None:
    solution = wb.solve(knapsack().program, "highs", bound_time=60.0)
    assert solution.status == "optimal" and solution.bound_kind == "verified"
    assert solution.certificate.gap == 0.0
    none = wb.solve(without_answer().program, "highs", bound_time=60.0)
    assert none.status == "infeasible" and none.certificate.infeasible
