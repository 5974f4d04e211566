"""Nothing that searches in this process goes on for long once it is asked to stop, and none is kept from its end by extreme weights."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numba.core.event import install_recorder
from programs import AnsweredBy

from waybound import BinAssignment, GeneralisedAssignment, JointAssignment, OrchardDay, OrchardJobs, RiskAllocation, RoomExploration, solve
from waybound.formulations.problem import Problem, problem_from_instance
from waybound.formulations.routing.objective import LongestRoute, Objective, Reward
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.formulations.sata.submodular_selection import SubmodularSelection
from waybound.formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from waybound.formulations.stop import Stop
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.auctions.exploration_map import ExplorationMap
from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.errors import WayboundError
from waybound.instances.generating import generate
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.instances.sata.constraints import Cardinality, Knapsack, PartitionMatroid
from waybound.instances.sata.sensing_graph import SensingGraph
from waybound.instances.sata.set_functions import Coverage, DenseFacilityLocation, UserFunction
from waybound.solvers.backend import BACKENDS, Control, Engine, Options
from waybound.solvers.bounds import BOUNDS
from waybound.solving.bounding import find_bounds
from waybound.solving.method import heuristic_run

LATE = 2.0
"""Seconds of computing after which nothing may still run, counted in this process, so that nobody else's work adds to them."""

NEVER_DONE = 300.0

BUDGET = 6.0
"""What bounding has where nothing else is said."""


def graph(robots: int, actions: int, targets: int, degree: int, weights: Any = None) -> SensingGraph:
    rng = np.random.default_rng(1)
    seen = np.sort(rng.integers(0, targets, (robots * actions, degree)), axis=1)
    kept = np.diff(seen, axis=1, prepend=-1) > 0
    starts = np.concatenate([[0], np.cumsum(kept.sum(axis=1))]).astype(np.int32)
    owner = np.repeat(np.arange(robots, dtype=np.int32), actions)
    size = int(kept.sum())
    given = rng.uniform(0.5, 1.5, size) if weights is None else rng.choice(weights, size)
    return SensingGraph(owner, starts, seen[kept].astype(np.int32), given, robots, targets)


def routing(n: int, **fleet: Any) -> RoutingProblem:
    rng = np.random.default_rng(1)
    sites = Sites.of(range(n), demand=np.concatenate([[0], rng.integers(1, 10, n - 1)]))
    return RoutingProblem(sites, Travel("EUC_2D", rng.uniform(0, 1e4, (n, 2)).round()), (VehicleType(**fleet),))


def coverage(n: int, items: int, each: int) -> Coverage:
    rng = np.random.default_rng(1)
    return Coverage.from_sets([rng.integers(0, items, each) for _ in range(n)], rng.random(items))


def slow(masks: Any) -> Any:
    time.sleep(1e-4 * len(masks))
    return np.sqrt(masks.sum(axis=1))


@cache
def large(kind: str, part: int = 1) -> Problem:
    """A problem that keeps everybody busy for long, or one of the same kind that is so much smaller and is soon done."""
    of = lambda size: max(4, size // part)  # noqa: E731
    match kind:
        case "winner-takes-all":
            return WinnerTakesAllSATA(graph(of(20_000), 2, of(5_000), min(50, of(5_000))))
        case "bottleneck":
            return BottleneckSATA(graph(of(20_000), 2, of(5_000), min(50, of(5_000))))
        case "bottleneck-lp":
            return BottleneckSATA(graph(of(20_000), 2, of(5_000), min(50, of(5_000))), fractional=True)
        case "sparse-bottleneck-lp":
            return BottleneckSATA(graph(of(4_000), 2, of(8_000), 4), fractional=True)
        case "small-bottleneck":
            return BottleneckSATA(graph(of(23), 2, of(400), min(40, of(400))))
        case "cardinality":
            return SubmodularSelection(coverage(of(4_000), of(4_000), 100), Cardinality(of(2_000)))
        case "dense":
            return SubmodularSelection(
                DenseFacilityLocation(np.random.default_rng(1).random((of(4_000), of(2_000)))), Cardinality(of(2_000))
            )
        case "knapsack":
            return SubmodularSelection(coverage(of(400), of(500), 50), Knapsack(np.random.default_rng(1).uniform(1, 2, of(400)), 60.0))
        case "small-knapsack":
            return SubmodularSelection(coverage(of(23), of(2_000), 100), Knapsack(np.ones(of(23)), 12.0))
        case "user":
            return SubmodularSelection(UserFunction(slow, of(300), monotone=True, submodular=True), Cardinality(of(150)))
        case "user-knapsack":
            return SubmodularSelection(UserFunction(slow, of(300), monotone=True, submodular=True), Knapsack(np.ones(of(300)), 150.0))
        case "user-groups":
            return SubmodularSelection(
                UserFunction(slow, of(300), monotone=True, submodular=True),
                PartitionMatroid(np.arange(of(300)) % 100, np.ones(100, dtype=int)),
            )
        case "tsp":
            return routing(of(20_000), count=1)
        case "tour":
            return routing(of(6_000), count=1)
        case "even":
            return replace(routing(of(4_000), count=20), objective=Objective.of(LongestRoute()))
        case "outing":
            made = routing(of(4_000), count=20, max_distance=1e5)
            sites = replace(made.sites, required=np.zeros(of(4_000), dtype=bool), reward=np.ones(of(4_000)))
            return replace(made, sites=sites, objective=Objective.of(Reward()))
        case "map":
            return problem_from_instance(generate("risky-grid", 1, rows=of(60), columns=of(60), mud=0.3, tether=True))
        case "rewards":
            return problem_from_instance(generate("risky-grid", 1, rows=of(30), columns=of(30), mud=0.3, rewards=of(300)))
        case "plan":
            return RiskAllocation(generate("risk-allocation", 1, family="corridor", steps=of(150), constraints=4))
        case "joint-plan":
            return RiskAllocation(generate("risk-allocation", 1, family="corridor", steps=of(60), constraints=4, risk="joint"))
        case "routes":
            return routing(of(200), capacity=200)
        case "risks":
            made = routing(of(200), max_duration=6e4, risk=0.05)
            return replace(made, travel=replace(made.travel, variances=np.full((of(200), of(200)), 1e6)))
        case "distances":
            return routing(of(6_000), max_distance=6e4)
        case "rooms":
            return RoomExploration(generate("exploration-map", 1, rooms=of(500), robots=of(50), steps=of(1000), silence=20))
        case "corridor":
            ends, gains = np.arange(of(4_000) - 1), np.ones((of(4_000), 3))
            doors = np.column_stack([ends, ends + 1])
            return RoomExploration(ExplorationMap(doors, gains, gains, gains, [0] * of(50), 0, doors, 1000, of(1000)))
        case "jobs":
            return GeneralisedAssignment(generate("generalised-assignment", 1, agents=of(40), jobs=of(4_000), costs="d"))
        case "profits":
            rng = np.random.default_rng(1)
            shape = of(100), of(4_000)
            used = rng.uniform(1, 100, shape)
            return GeneralisedAssignment.from_arrays(used + rng.uniform(0, 1, shape), used, used.sum(axis=1) / 200, "profit")
        case "errands":
            robots, bins, requests = (np.random.default_rng(k).uniform(0, 1e4, (k, 2)) for k in (of(2_001), of(2_000), 4))
            away = lambda a, b: np.hypot(*(a[:, None] - b).transpose(2, 0, 1))  # noqa: E731
            return JointAssignment.from_arrays(away(robots, bins), away(robots, requests), away(requests, bins))
        case "pairs":
            return BinAssignment(generate("assignment", 1, robots=of(2_000), bins=of(2_000), costs="euclidean"))
        case "tasks":
            return problem_from_instance(generate("robot-tasks", 1, robots=4, tasks=of(4_000)))
        case "parts":
            return problem_from_instance(generate("robot-tasks", 1, robots=4, tasks=of(2_000), problem="balanced-partition"))
        case "orchard":
            rng, count = np.random.default_rng(1), of(200_000)
            grid = OrchardGrid(20, 20)
            cells, robots = rng.choice(grid.harvested, count), np.full(of(2_000), grid.home)
            ones = np.ones(count, dtype=bool)
            return OrchardDay(OrchardJobs(grid, robots, 0 * robots, cells, np.full(count, -1), ones, np.zeros(count, dtype=int)))
        case "roadmap":
            return problem_from_instance(generate("prm-graph", 1, vertices=of(3_000)))
        case _:
            return routing(of(1_200), capacity=100)


LONG: list[tuple[str, str, dict[str, Any]]] = [
    ("additive-risk", "map", {}), ("bertsekas", "pairs", {"epsilon": 1e-6, "scaling": False}), ("auction", "pairs", {}),
    ("online-greedy", "pairs", {}), ("bins-then-requests", "errands", {}), ("brute-force", "small-knapsack", {}),
    ("brute-force", "small-bottleneck", {}), ("christofides", "tour", {}), ("consensus-bundle", "tasks", {}),
    ("continuous-greedy", "winner-takes-all", {"steps": 100_000}), ("continuous-greedy", "cardinality", {"steps": 1_000_000}),
    ("cvar", "joint-plan", {"samples": 2_000}), ("distributed-sampling", "parts", {"initial": "first"}),
    ("fixed-order-auction", "tasks", {}), ("greedy", "winner-takes-all", {"evaluation": "plain"}),
    ("greedy", "winner-takes-all", {"evaluation": "incremental"}), ("greedy", "dense", {"evaluation": "plain"}),
    ("greedy", "bottleneck", {}), ("greedy", "user", {}), ("greedy-assignment", "outing", {}), ("greedy-orienteering", "outing", {}),
    ("heard-greedy", "rooms", {}), ("heard-greedy", "corridor", {}), ("insertion", "routing", {}), ("insertion", "distances", {}),
    ("insertion", "tour", {}), ("iterative", "plan", {"epsilon": 0.0, "rounds": 100_000}),
    ("knapsack-greedy", "knapsack", {"enumerate": 3}), ("least-mean", "roadmap", {}), ("knapsack-greedy", "user-knapsack", {}),
    ("lazy-greedy", "winner-takes-all", {}), ("list-schedule", "orchard", {}), ("local-ratio", "profits", {}),
    ("local", "bottleneck-lp", {"h": 1000}), ("local", "bottleneck", {"h": 100, "search": "step", "step": 1e-6}),
    ("local", "sparse-bottleneck-lp", {"h": 100, "messages": True}), ("look-back", "map", {"steps": 3}), ("lp-rounding", "cardinality", {}),
    ("parallel-auction", "tasks", {}), ("pure-greedy", "outing", {}), ("rags", "roadmap", {}), ("random", "winner-takes-all", {}),
    ("safety-margins", "risks", {}), ("savings", "tsp", {}), ("savings", "distances", {}),
    ("scenario", "joint-plan", {"confidence": 0.999999}), ("sequential-greedy", "winner-takes-all", {}),
    ("sequential-greedy", "user-groups", {}), ("sequential-single-item", "tasks", {"paths": "optimal"}),
    ("sequential-single-item", "tasks", {}), ("shmoys-tardos", "jobs", {}), ("split", "distances", {}),
    ("split", "tour", {"tour": "nearest-neighbour"}), ("stochastic-greedy", "dense", {}), ("stochastic-greedy", "user", {}),
    ("tour-partitioning", "routing", {}), ("tour-splitting", "even", {}), ("two-stage", "rewards", {"steps": 3}),
]  # fmt: skip


def lateness(run: Callable[[Control], Any], seconds: float) -> tuple[float, Any]:
    """How long ``run(control)`` computes after it was asked to stop, and what it returned."""
    control, asked = Control(), [0.0]

    def stop() -> None:
        asked[0] = time.process_time()
        control.stop()

    clock = threading.Timer(seconds, stop)
    clock.start()
    result = run(control)
    ended = time.process_time()
    clock.cancel()
    return (ended - asked[0] if asked[0] else 0.0), result


def warm(run: Callable[[Control], Any], seconds: float) -> None:
    """Compile what ``run`` needs: what comes late in it is not reached before all that comes earlier is compiled."""
    while True:
        with install_recorder("numba:compile") as compiled:
            lateness(run, seconds)
        if not compiled.buffer:
            return


def test_all_heuristics_are_stopped_here() -> None:
    assert {name for name, _, _ in LONG} == set(HEURISTICS)


FIRST = {name: case for case, (name, _, _) in reversed(list(enumerate(LONG)))}
"""The case of each heuristic in the fast share."""

CASES = [
    pytest.param(*case, id=f"{case[0]}-{case[1]}", marks=() if FIRST[case[0]] == number else pytest.mark.hostile)
    for number, case in enumerate(LONG)
]


@pytest.mark.share(2)
@pytest.mark.parametrize(("name", "kind", "options"), CASES)
def test_a_heuristic_ends_with_what_it_has(name: str, kind: str, options: dict[str, Any], share: Any, tally: Any) -> None:
    problem, rng = large(kind), np.random.default_rng(7)
    go = heuristic_run(problem, name, Options(time_limit=NEVER_DONE, extra=options), False).go
    warm(heuristic_run(large(kind, 50), name, Options(time_limit=NEVER_DONE, extra=options), False).go, 0.3)
    warm(go, 0.1)  # a size of its own may have loops of its own
    for seconds in rng.uniform(0.0, 0.2, share(1, 1)).tolist() + rng.uniform(0.0, 3.0, share(0, 3)).tolist():
        late, result = lateness(go, seconds)
        assert late < LATE
        if result.answer is not None:
            # Insertion begins with a route for each customer, more than the one vehicle: ``solve`` takes such an answer for none.
            excused = {"fleet"} if (name, kind) == ("insertion", "tour") else set()
            assert {v.check for v in problem.evaluate(result.answer).violations} <= excused
        assert result.limit in ("interrupt", "none")
        tally["heuristics that were asked to stop"] += 1


@pytest.mark.parametrize(
    "kind", ["winner-takes-all", "dense", "user", "bottleneck", "routing", "routes", "tsp", "roadmap", "tasks", "parts"]
)
@pytest.mark.parametrize("name", sorted(BOUNDS))
def test_a_bound_is_no_reason_to_go_on(name: str, kind: str, share: Any, compiled: Any, tally: Any) -> None:
    problem, method, rng = large(kind), BOUNDS[name], np.random.default_rng(8)
    if method.missing(problem):
        return
    method.prepare()
    compiled(method.kernels)
    for seconds in rng.uniform(0.0, 0.2, share(1, 1)).tolist() + rng.uniform(0.0, 3.0, share(0, 4)).tolist():
        stop = Stop(BUDGET)

        def go(control: Control, stop: Stop = stop) -> None:
            control.on_stop(stop.ask)
            method.compute(problem, stop, AnsweredBy(lambda *_: None))

        late, _ = lateness(go, seconds)
        assert late < LATE
        tally["bounds that were asked to stop"] += 1
    began = time.process_time()
    method.compute(problem, Stop(0.2), AnsweredBy(lambda *_: None))
    assert time.process_time() - began < 0.2 + LATE


@pytest.mark.parametrize("kind", ["winner-takes-all", "bottleneck", "routing"])
def test_bounding_ends(kind: str, share: Any, tally: Any) -> None:
    for method in BOUNDS.values():
        if not method.missing(large(kind)):
            method.prepare()
    find_bounds(large(kind, 50), 1.0)  # compiles what else it needs
    for seconds in np.random.default_rng(9).uniform(0.0, 0.4, share(1, 6)).tolist():
        late, _ = lateness(lambda control: find_bounds(large(kind), BUDGET, control=control), seconds)
        assert late < LATE
        tally["boundings that were asked to stop"] += 1


@pytest.mark.share(2)
@pytest.mark.parametrize("h", [0, 1000])
def test_saddle_ends(h: int, share: Any, tally: Any) -> None:
    engine = BACKENDS["saddle"]()
    assert isinstance(engine, Engine)
    problem = large("bottleneck-lp")
    go = lambda control: engine.run(problem, Options(time_limit=60.0, extra={"h": h}), control)  # noqa: E731
    engine.run(large("bottleneck-lp", 50), Options(time_limit=60.0, extra={"h": h}), Control())  # compiles all of it
    warm(go, 0.1)
    for seconds in np.random.default_rng(10).uniform(0.0, 0.5, share(1, 6)).tolist():
        late, result = lateness(go, seconds)
        assert late < LATE
        assert problem.evaluate(result.answer).feasible
        tally["engines that were asked to stop"] += 1


def test_greedy_keeps_its_time() -> None:
    began = time.process_time()
    solution = solve(large("winner-takes-all"), heuristic="greedy", evaluation="plain", time_limit=0.3, bound_time=0.2)
    assert solution.limit == "time" and solution.status == "feasible"
    assert solution.certificate.guarantee is None
    assert time.process_time() - began < 0.5 + 2 * LATE


SIZES = (5e-324, 1e-310, 2.3e-308, 1e-300, 1e-100, 1.0, 1e100, 1e300, 1e306)


def extreme(rng: np.random.Generator) -> Any:
    """A few sizes of weights, from one to all of them."""
    return rng.choice(SIZES, int(rng.integers(1, 4)), replace=False) * (1.0 if rng.random() < 0.5 else rng.uniform(0.5, 1.0))


def small(rng: np.random.Generator, kind: str) -> Problem:
    weights = extreme(rng)
    if kind in ("winner-takes-all", "bottleneck", "bottleneck-lp"):
        g = graph(4, 2, 5, 4, weights)
        return WinnerTakesAllSATA(g) if kind == "winner-takes-all" else BottleneckSATA(g, fractional=kind == "bottleneck-lp")
    n = 7
    constraint = Knapsack(rng.choice(extreme(rng), n), float(rng.choice(SIZES))) if kind == "knapsack" else Cardinality(3)
    if rng.random() < 0.5:
        return SubmodularSelection(DenseFacilityLocation(rng.choice(weights, (n, 4))), constraint)
    return SubmodularSelection(Coverage.from_sets([rng.integers(0, 5, 3) for _ in range(n)], rng.choice(weights, 5)), constraint)


@pytest.mark.parametrize("kind", ["winner-takes-all", "bottleneck", "bottleneck-lp", "cardinality", "knapsack"])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # sums beyond the largest number
def test_extreme_weights_end(kind: str, share: Any, tally: Any) -> None:
    rng = np.random.default_rng(11)
    for _ in range(share(2, 150)):
        problem = small(rng, kind)
        for name in HEURISTICS:
            if HEURISTICS[name].missing(problem):
                continue
            run = heuristic_run(problem, name, Options(time_limit=5.0), False)
            began = time.process_time()
            try:
                run.go(Control())
            except WayboundError:  # weights that it refuses
                tally["heuristics that refuse weights"] += 1
            assert time.process_time() - began < 5.0 + LATE
        for name in BOUNDS:
            if BOUNDS[name].missing(problem):
                continue
            BOUNDS[name].prepare()
            began = time.process_time()
            BOUNDS[name].compute(problem, Stop(1.0), AnsweredBy(lambda *_: None))
            assert time.process_time() - began < 1.0 + LATE
        tally["instances of extreme weights"] += 1
