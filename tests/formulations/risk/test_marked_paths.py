import re
from dataclasses import replace

import numpy as np
import pytest
import risky_cases as cases
from patience import HANG

import waybound as wb
from waybound import InputError, RiskyGraph, RiskyPath
from waybound.formulations.risk import marked_paths, risky_path
from waybound.formulations.risk.marked_paths import CutShortError, free_reward
from waybound.formulations.stop import Stop
from waybound.instances.risk.elements import LocaleRisk, MoveRisk
from waybound.instances.risk.traverse_elements import CollectedRisk, FunctionRisk, TravelledRisk


def drawn(rng: np.random.Generator) -> RiskyGraph:
    """Mostly without risk: of places, pairs of moves, what was collected, and the way beyond a free one."""
    n = int(rng.integers(2, 7))
    tail, head = np.nonzero((rng.random((n, n)) < 0.45) & ~np.eye(n, dtype=bool) | np.eye(n, k=1, dtype=bool))
    some = lambda size, share: rng.uniform(0.1, 0.9, size) * (rng.random(size) < share)  # noqa: E731
    places = some(n, 0.3)
    places[0] *= rng.random() < 0.2
    elements = [LocaleRisk(places)]
    if rng.random() < 0.5:
        before = rng.integers(-1, n, len(tail))
        elements.append(MoveRisk(before, tail, head, some(len(tail), 0.5)))
    if rng.random() < 0.4:
        elements.append(CollectedRisk(rng.random(n) < 0.5, np.array([np.zeros(n), some(n, 0.7)]), "mud"))
    if rng.random() < 0.4:
        elements.append(TravelledRisk(0.1, float(rng.uniform(0.0, 3.0))))
    if rng.random() < 0.2:
        elements.append(FunctionRisk(lambda path: 0.2 * (len(path) > 2 and path[1] % 2 == 0), "second"))
    goals = tuple(np.nonzero(rng.random(n) < 0.4)[0].tolist()) if rng.random() < 0.7 else ()
    rewards = rng.integers(1, 9, n) * (rng.random(n) < 0.3)
    rewards[int(rng.integers(n))] = 1.0
    return RiskyGraph(
        n, tail, head, tuple(elements), 0, True, goals, rewards, float(rng.choice([1.0, 0.5, 0.0])), "reward-per-risk",
        positions=rng.uniform(0.0, 2.0, (n, 2)),
    )  # fmt: skip


@pytest.mark.share(3)
@pytest.mark.parametrize("part", range(6))
def test_a_problem_is_refused_where_a_path_has_a_reward_without_risk_and_else_solved(part: int) -> None:
    rng, refused, zero = np.random.default_rng([93, part]), 0, 0
    for case in range(50):
        graph = drawn(rng)
        oracle = RiskyPath(replace(graph, objective="risk", goals=tuple(range(graph.num_states))))
        paths = [path for path in cases.all_paths(oracle) if not graph.goals or path[-1] in graph.goals]
        known = [(oracle.evaluate(path), path) for path in paths]
        able = [(e.quantities["risk"], oracle._reward(path)) for e, path in known if e.feasible]
        try:
            problem = RiskyPath(graph)
        except InputError as fault:
            assert any(risk == 0.0 and reward > 0.0 for risk, reward in able), (case, str(fault))
            assert re.search("no maximum: a reward is reached without risk", str(fault))
            refused += 1
            continue
        assert not any(risk == 0.0 and reward > 0.0 for risk, reward in able), case
        best = max((reward / risk for risk, reward in able if risk > 0.0), default=None)
        zero += best == 0.0
        for method in ({"solver": "risk-labels"}, {"solver": "path-enumeration"}, {"heuristic": "two-stage"}):
            solution = wb.solve(problem, bound_time=0, **method)
            assert (solution.answer is None) == (best is None), (case, method)
            if best is not None and method != {"heuristic": "two-stage"}:
                assert solution.objective == pytest.approx(best), (case, method)
                assert solution.status == "optimal"
            elif best is None and "solver" in method:
                assert solution.status == "infeasible"
    assert refused > 10


def test_the_best_value_may_be_nothing() -> None:
    moves = MoveRisk([0], [1], [2], [0.3])
    graph = cases.graph([(0, 1), (1, 2), (0, 2)], [moves], goals=(2,), rewards=[0, 1, 0], discount=0.0, objective="reward-per-risk")
    for given in ({}, {"solver": "path-enumeration"}, {"heuristic": "two-stage"}):
        solution = wb.solve(RiskyPath(graph), bound_time=HANG, **given)
        assert (solution.status, solution.objective, solution.answer, solution.bound_kind) == ("optimal", 0.0, (0, 1, 2), "verified")


def test_what_cannot_be_decided_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    n = 7
    arcs = [(a, b) for a in range(n) for b in range(n) if a != b]
    late = FunctionRisk(lambda path: 0.5 * (path[-1] == n - 1), "late")
    given = {"goals": (n - 1,), "rewards": np.arange(n) == n - 1, "objective": "reward-per-risk"}
    monkeypatch.setattr(risky_path, "free_reward", lambda problem: free_reward(problem, 100))
    with pytest.raises(InputError, match="was not decided with 200000 labels"):
        RiskyPath(cases.graph(arcs, [late], **given))
    monkeypatch.undo()
    assert wb.solve(RiskyPath(cases.graph(arcs, [late], **given)), bound_time=0).objective == pytest.approx(2.0)


def test_a_search_for_any_risk_ends_when_it_shall() -> None:
    assert marked_paths.risky_path(cases.two_ways()) == (0, 1)
    with pytest.raises(CutShortError, match="iterations"):
        marked_paths.risky_path(cases.mud(objective="risk"), most=0)
    stop = Stop()
    stop.ask()
    large = cases.graph([(a, b) for a in range(40) for b in range(40) if a != b], [LocaleRisk(np.zeros(40))], goals=(39,))
    with pytest.raises(CutShortError):
        marked_paths.risky_path(RiskyPath(large), stop)
