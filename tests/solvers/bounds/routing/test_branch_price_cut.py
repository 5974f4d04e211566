import json
import math
import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from draws import ALL, draws
from hypothesis import given, settings
from oracles import set_partitioning_bound, small_problems
from patience import HANG
from small_routing import plane, small
from truth.routing import best_values

import waybound as wb
from waybound import Evidence, RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.certificate import certify, check_certificate
from waybound.formulations.routing.checking import set_partitioning_duals
from waybound.formulations.routing.checking.relaxation import relax
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS, proof_tree
from waybound.solvers.bounds.branching_tree import branching_tree_bound
from waybound.solvers.bounds.routing import branch_price_cut, column_generation
from waybound.solvers.bounds.routing.branch_price_cut import branch_price_cut_bound
from waybound.solvers.bounds.routing.column_generation import ColumnGeneration
from waybound.solvers.bounds.routing.pricing import Pricer
from waybound.solvers.linear_programs import LinearPrograms

PROVED = (
    "capacity", "time-windows", "depot-windows", "service-times", "max-distance", "travel", "elapsed-fixed-start", "limited-fleet",
    "fixed-cost", "open-routes",
)  # fmt: skip


pytestmark = pytest.mark.usefixtures("compiled_pricing")


def leaves(evidence: Evidence) -> list[dict[str, Any]]:
    return [node for node in evidence.data["nodes"] if "branch" not in node]


def assert_optimum_is_proved(problem: RoutingProblem, evidence: Evidence | None) -> None:
    """By a certificate that is written, read and checked again."""
    assert evidence is not None
    best, made = best_values(problem), certify(problem, None, [evidence])
    again = check_certificate(problem, json.loads(json.dumps(made.to_json(with_evidence=True), allow_nan=False)), None)
    if best is None:
        assert again.infeasible
    else:
        assert again.bound == pytest.approx(best[0], rel=1e-9)


def assert_no_more_is_proved(problem: RoutingProblem, name: str, stop: Stop) -> None:
    if BOUNDS[name].missing(problem):
        return
    evidence, best = BOUNDS[name].evidence(problem, stop, LinearPrograms()), best_values(problem)
    if evidence is not None:
        sign = 1.0 if problem.sense == "min" else -1.0
        assert sign * verified_bound(problem, evidence) <= (math.inf if best is None else sign * best[0] + 1e-9 * abs(best[0]))


def tree_of(problem: RoutingProblem) -> branch_price_cut.Tree:
    partition = branch_price_cut.set_partition(problem, Stop(HANG))
    assert partition is not None
    return branch_price_cut.Tree(problem, partition, None, Stop(HANG), 1)


def test_a_checker_that_cannot_follow_is_given_fewer_who_are_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, told = plane(1, 16, 40.0), list[int]()

    def checked(problem: Any, evidence: Evidence) -> float:
        told.append(max(map(len, evidence.data.get("remembered", [[0]]))) - 1)
        return verified_bound(problem, evidence) if told[-1] <= 4 else -math.inf

    monkeypatch.setattr(proof_tree, "verified_bound", checked)
    tree = tree_of(problem)
    assert tree.look(tree.root) and tree.root.evidence is not None and tree.remembered == 4
    assert tree.root.own == verified_bound(problem, tree.root.evidence) > -math.inf
    assert told[0] == 8 and told.index(4) <= 2 and max(told[told.index(4) :]) == 4  # with digits cut short, and whole


def test_a_first_linear_program_of_many_labels_is_proved_before_another_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    tree = tree_of(plane(3, 14, 30.0))
    monkeypatch.setattr(branch_price_cut, "LONG", 0)
    monkeypatch.setattr(tree.columns, "_remember", lambda solved: bool(tree.columns.near.fill(True)) or tree.whole.ask() is None)
    tree.look(tree.root)
    evidence = tree.root.evidence
    assert evidence is not None and max(map(len, evidence.data["remembered"])) == 9  # not as many as after that
    assert tree.root.own == verified_bound(tree.routing, evidence) > -math.inf


def test_a_ray_that_proves_nothing_takes_no_memory_from_other_proofs(monkeypatch: pytest.MonkeyPatch) -> None:
    tree = tree_of(plane(1, 16, 40.0))
    solved, before = tree.columns.solve(tree._part(tree.root), None), tree.remembered
    monkeypatch.setattr(proof_tree, "verified_bound", lambda problem, evidence: -math.inf)
    tree._prove(tree.root, replace(solved, bound=math.inf))
    assert tree.remembered == before
    tree._prove(tree.root, solved)
    assert tree.remembered == branch_price_cut.FOLLOWED[-1]


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", PROVED)
@pytest.mark.parametrize("seed", range(6 if ALL else 3))
def test_optima_of_small_problems_are_proved(feature: str, seed: int) -> None:
    problem = small(feature, seed, "exact")
    assert_optimum_is_proved(problem, branch_price_cut_bound(problem, Stop(60.0)))


@settings(max_examples=draws(40), deadline=None)
@given(problem=small_problems(most=3, hetero=True))
def test_nothing_more_than_the_optimum_is_proved(problem: RoutingProblem) -> None:
    assert_no_more_is_proved(problem, "branch-price-cut", Stop(20.0))


@pytest.mark.parametrize("seed", range(6))
def test_the_root_is_the_linear_relaxation_of_set_partitioning(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = small("time-windows", seed, "exact")
    monkeypatch.setattr(branch_price_cut.Tree, "branch", lambda self, node: False)
    monkeypatch.setattr(ColumnGeneration, "cut", lambda self, solved, rows: False)
    monkeypatch.setattr(branch_price_cut, "first_answer", lambda *arguments: None)
    evidence = branch_price_cut_bound(problem, Stop(60.0))
    assert evidence is not None and evidence.kind == "set-partitioning-duals"
    relaxed = relax(problem)
    assert verified_bound(problem, evidence) == pytest.approx(set_partitioning_bound(problem, relaxed.fewest), rel=1e-7)


@pytest.mark.parametrize("seed", range(4))
def test_moves_that_no_better_answer_makes_are_left_out_by_a_branching_with_a_proof(seed: int) -> None:
    problem = plane(seed, 12, 25.0)
    best = wb.solve(problem, "branch-price-cut").objective
    evidence = branch_price_cut_bound(problem, Stop(HANG), target=best)
    assert verified_bound(problem, evidence) == pytest.approx(best)
    if evidence.kind == "branching-tree":
        moves = [node["branch"]["moves"] for node in evidence.data["nodes"] if "moves" in node.get("branch", ())]
        assert moves and all(head in problem.site_index for heads in moves[0].values() for head in heads)
        lie = json.loads(json.dumps(evidence.data))
        first = next(node["branch"]["moves"] for node in lie["nodes"] if "moves" in node.get("branch", ()))
        tails = [site for site in problem.sites.ids if site not in first][:1] or [next(iter(first))]
        first.update({tail: [head for head in problem.sites.ids if head != tail] for tail in tails})  # moves that better answers make
        assert verified_bound(problem, replace(evidence, data=lie)) <= best * (1.0 + 1e-9)


def wrong_evidence(change: Callable[[dict[str, Any]], None]) -> Callable[[pytest.MonkeyPatch], None]:
    def plant(patch: pytest.MonkeyPatch) -> None:
        true = branch_price_cut.Tree._evidence

        def told(self: Any, solved: Any, more: Any) -> Evidence:
            evidence = true(self, solved, more)
            change(evidence.data)
            return evidence

        patch.setattr(branch_price_cut.Tree, "_evidence", told)

    return plant


def turned_signs(data: dict[str, Any]) -> None:
    for row in (*data.get("rows", ()), *data.get("loads", ())):
        row["price"] *= -1.0


def short_memories(data: dict[str, Any]) -> None:
    for row in data.get("rows", ()):
        row["memory"] = row["sites"]


def dear_visits(data: dict[str, Any]) -> None:
    data["visits"] = [1.05 * price for price in data["visits"]]


def no_walks_below(data: dict[str, Any]) -> None:
    data["least"] = data["least_needed"] = 0.0


def early_stop(patch: pytest.MonkeyPatch) -> None:
    """Nobody is looked for: the routes at hand are said to be all."""
    patch.setattr(Pricer, "search", lambda self, stop, reduced, duals, how, most, below: (0, below, np.zeros(0), []))


def lost_labels(patch: pytest.MonkeyPatch) -> None:
    true = Pricer.search

    def found(self: Pricer, *asked: Any) -> Any:
        status, least, totals, routes = true(self, *asked)
        return status, 0.5 * least, totals[1::2], routes[1::2]

    patch.setattr(Pricer, "search", found)


def wrongly_left_out(patch: pytest.MonkeyPatch) -> None:
    """Moves that the routes at hand make are said to be made by none that matters."""

    def hopeless(self: ColumnGeneration, part: Any, solved: Any, gap: float) -> Any:
        return self.pool.flow(solved.values, part.cost.shape).sum(axis=0) > 0.0

    patch.setattr(ColumnGeneration, "hopeless", hopeless)


FAULTS: dict[str, Callable[[pytest.MonkeyPatch], None]] = {
    "an early stop": early_stop, "lost labels": lost_labels, "moves that are wrongly left out": wrongly_left_out,
    "signs of cuts": wrong_evidence(turned_signs), "memories of cuts": wrong_evidence(short_memories),
    "wrong prices": wrong_evidence(dear_visits), "claims that are not true": wrong_evidence(no_walks_below),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_a_search_that_errs_proves_nothing_that_is_false(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problems = [*(plane(seed, 7, 17.0) for seed in range(3)), small("time-windows", 2, "exact"), small("prizes", 1, "exact")]
    FAULTS[fault](monkeypatch)
    for problem in problems:
        best, sign = best_values(problem), 1.0 if problem.sense == "min" else -1.0
        for target in (best[0], None):
            evidence = branch_price_cut_bound(problem, Stop(0.8), target=target)
            if evidence is not None:
                assert sign * (verified_bound(problem, evidence) - best[0]) <= 1e-9 * abs(best[0])


@pytest.mark.parametrize("seed", range(3))
def test_capacities_alone_take_branchings(seed: int) -> None:
    problem = plane(seed, 12, 20.0)
    evidence = branch_price_cut_bound(problem, Stop(120.0))
    bound = verified_bound(problem, evidence)
    assert bound == evidence.value
    solution = wb.solve(problem, "pyvrp", iterations=300, bound_time=0)
    assert bound == solution.objective
    told = branch_price_cut_bound(problem, Stop(120.0), target=solution.objective)
    assert told is not None and verified_bound(problem, told) == bound


def test_numbers_of_routes_and_moves_are_branched_on(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = set[str]()
    monkeypatch.setattr(ColumnGeneration, "cut", lambda self, solved, rows: False)
    monkeypatch.setattr("waybound.solvers.bounds.routing.branch_price_cut.ROUTES", 0)
    for problem in (*(plane(seed, 9, 17.0) for seed in range(12)), *(small("time-windows", seed, "exact") for seed in range(12))):
        evidence = branch_price_cut_bound(problem, Stop(60.0))
        if evidence.kind == "branching-tree":
            seen |= {key for node in evidence.data["nodes"] for key in node.get("branch", ())}
            assert all(leaf["kind"] == "set-partitioning-duals" for leaf in leaves(evidence) if leaf)
    assert seen >= {"arc", "moves", "routes"}


def test_a_fleet_that_is_too_small_for_the_packing_is_proved_so() -> None:
    # Loads 6, 6, 6, 6, 6 and 3: two vehicles of 18 hold the sum, and no more than three each; a third of them is not there.
    rng = np.random.default_rng(1)
    sites = Sites.of(range(8), demand=[0, 7, 7, 7, 7, 7, 1, 0])
    problem = RoutingProblem(sites, Travel("EUC_2D", rng.integers(0, 50, (8, 2)).astype(float)), (VehicleType(2, 18.0),))
    assert best_values(problem) is None
    evidence = branch_price_cut_bound(problem, Stop(60.0))
    assert evidence is not None and verified_bound(problem, evidence) == math.inf


@pytest.mark.slow
def test_more_is_remembered_where_a_route_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(column_generation, "MEMORY", 0)
    for seed in range(4):
        problem = plane(seed, 6, 20.0)
        best, evidence = best_values(problem), branch_price_cut_bound(problem, Stop(60.0))
        assert verified_bound(problem, evidence) == pytest.approx(best[0])


def test_where_labels_are_too_many_it_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(column_generation, "LABELS", 5)
    assert branch_price_cut_bound(plane(1, 10, 30.0), Stop(10.0)) is None


@pytest.mark.slow
def test_what_proves_nothing_to_the_checker_counts_for_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(set_partitioning_duals, "LABELS", 3)
    evidence = branch_price_cut_bound(plane(1, 10, 30.0), Stop(4.0))
    assert evidence is None or verified_bound(plane(1, 10, 30.0), evidence) == -math.inf


@pytest.mark.slow
def test_it_ends_when_it_is_asked_to_and_hands_over_what_it_has() -> None:
    problem = plane(5, 60, 60.0)
    for seconds in (0.0, 0.05, 0.8):
        stop = Stop(HANG)
        clock = threading.Timer(seconds, stop.ask)
        clock.start()
        evidence = branch_price_cut_bound(problem, stop)
        assert stop.reached() == "interrupt"
        if evidence is not None:
            assert verified_bound(problem, evidence) == evidence.value


@pytest.mark.slow
def test_the_same_seed_gives_the_same_evidence() -> None:
    first, second = (branch_price_cut_bound(plane(2, 12, 25.0), Stop(120.0)) for _ in range(2))
    assert first == second and first is not None


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", PROVED)
@pytest.mark.parametrize("seed", range(6 if ALL else 2))
def test_trees_of_moves_prove_optima_of_small_problems(feature: str, seed: int) -> None:
    problem = small(feature, seed, "exact")
    assert_optimum_is_proved(problem, branching_tree_bound(problem, Stop(30.0)))


@settings(max_examples=draws(60), deadline=None)
@given(problem=small_problems(most=4))
def test_trees_never_prove_more_than_the_optimum(problem: RoutingProblem) -> None:
    assert_no_more_is_proved(problem, "branching-tree", Stop(10.0))
