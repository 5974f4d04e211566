"""The largest of all routes by bisection over a limit: the optimum of small problems, the best answer always kept, nothing claimed of what
was not found."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest
from patience import HANG
from small_routing import small, varied
from truth.routing import best_values

from waybound import Exactness, LatestReturn, LongestRoute, Makespan, Objective, Reward, Routes, RoutingProblem, TotalCost, Travel, Vehicles
from waybound.formulations.routing.objective import Composable
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.solvers.backend import BACKENDS, Control, Options, RawResult
from waybound.solvers.engines.routing.bisection import Bisecting, Bisection

WORK = 300
"""Iterations of PyVRP that are enough for five customers under every limit."""


def asking(problem: RoutingProblem, *goals: Composable) -> RoutingProblem:
    first, *others = (Objective.of(goal) for goal in goals)
    for other in others:
        first = first.then(other)
    return replace(problem, objective=first)


@pytest.mark.share(2)
@pytest.mark.share(3)
@pytest.mark.parametrize(
    "goals",
    [
        (Makespan(),), (LongestRoute(),), (3.0 * LatestReturn(),), (Reward(), Makespan()), (Vehicles(), LongestRoute()),
        (Makespan(), TotalCost()), (Vehicles(), LatestReturn(), TotalCost()),
    ],
    ids=str,
)  # fmt: skip
def test_the_least_maximum_of_small_problems_is_found(goals: tuple[Composable, ...]) -> None:
    asked = [asking(varied(f, seed, 4), *goals) for f in ("several-loads", "groups", "shifts") for seed in range(2)]
    asked += [asking(small("time-windows", 1, "exact"), *goals)]
    engine = BACKENDS["pyvrp"]()
    for problem in asked:
        assert not engine.missing(problem)
        best = best_values(problem)
        found = engine.run(problem, Options(time_limit=10.0, iterations=WORK), Control())
        assert (found.answer is None) == (best is None)
        if best is not None:
            verdict = problem.evaluate(found.answer)
            assert verdict.feasible
            assert verdict.values == pytest.approx(best)
            assert found.status == "feasible"
            assert found.bound is None
            assert found.holds is Exactness.RESTRICTION
            assert found.links[-1].name == "bisection"


@pytest.mark.parametrize(("engine", "waits"), [("vroom", False), ("ortools", True)])
def test_engines_take_what_their_limits_express(engine: str, waits: bool) -> None:
    made = BACKENDS[engine]()
    if not made.installed():
        pytest.skip(f"{engine} is not installed")
    problem = asking(small("time-windows" if waits else "capacity", 0, "round"), Makespan())
    work = None if engine == "vroom" else 200
    found = made.run(problem, Options(time_limit=HANG, iterations=work), Control())
    assert problem.evaluate(found.answer).values == pytest.approx(best_values(problem))


def test_work_limits_repeat_and_are_kept() -> None:
    problem = asking(small("capacity", 2, "exact"), Makespan())
    runs = [BACKENDS["pyvrp"]().run(problem, Options(time_limit=20.0, iterations=150, seed=3), Control()) for _ in range(2)]
    assert runs[0].answer == runs[1].answer
    assert runs[0].statistics["iterations"] == runs[1].statistics["iterations"] <= 150 + runs[0].statistics["limits_tried"]


@pytest.mark.slow
def test_the_time_limit_holds_for_all_limits_together() -> None:
    rng = np.random.default_rng(1)
    sites = Sites.of(range(81), demand=np.append(0.0, rng.integers(1, 9, 80)))
    travel = Travel("euclidean", rng.uniform(0, 100, (81, 2)))
    problem = RoutingProblem(sites, travel, (VehicleType(5, 120.0),), LongestRoute())
    began = time.perf_counter()
    heard: list[float] = []
    found = BACKENDS["pyvrp"]().run(problem, Options(time_limit=1.0), Control(lambda event: heard.append(event["objective"])))
    assert time.perf_counter() - began < HANG
    assert found.limit == "time"
    assert heard == sorted(heard, reverse=True)
    assert found.objective == heard[-1] == pytest.approx(problem.evaluate(found.answer).values[0])


class Scripted(Bisecting):
    """Answers with the shortest of the routes that it knows and that keep the limit, and finds nothing below ``blind``."""

    name, family = "scripted", "routing"
    features = frozenset({"objective:longest-route", "objective:total-cost", "max-distance", "limited-fleet"})

    def __init__(self, known: list[Routes], blind: float = 0.0) -> None:
        super().__init__()
        self.known, self.blind, self.limits = known, blind, list[float]()

    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        return frozenset()

    def search(self, problem: RoutingProblem, options: Options, control: Control) -> RawResult:
        limit = problem.fleet[0].max_distance
        self.limits.append(limit)
        kept = [answer for answer in self.known if problem.evaluate(answer).feasible] if limit >= self.blind else []
        for answer in kept[:1]:
            control.publish(answer, 0.0)
        return RawResult("feasible" if kept else "unknown", answer=kept[0] if kept else None)


LINE = RoutingProblem(
    Sites.of(range(4)), Travel("euclidean", np.array([[0.0, 0], [1, 0], [3, 0], [-6, 0]])), (VehicleType(3),), LongestRoute()
)  # fmt: skip
ALL, TWO = Routes.of([[1, 2, 3]]), Routes.of([[1, 2], [3]])


def test_limits_close_in_on_the_best_value_and_an_unreachable_site_needs_no_search() -> None:
    engine = Scripted([ALL, TWO])
    found = engine.run(LINE, Options(), Control())
    assert (found.answer, found.objective) == (TWO, 12.0)
    assert engine.limits[0] == math.inf
    assert all(limit >= 12.0 for limit in engine.limits)  # below, site 3 is out of reach
    assert found.statistics["limits_tried"] > len(engine.limits)


def test_an_engine_that_finds_nothing_below_keeps_the_answer_and_claims_no_bound() -> None:
    found = Scripted([ALL, TWO], blind=13.0).run(LINE, Options(), Control())
    assert (found.status, found.answer, found.bound) == ("feasible", TWO, None)
    assert Scripted([], blind=math.inf).run(LINE, Options(), Control()).status == "unknown"


def test_a_start_and_an_interrupt_leave_the_best_answer() -> None:
    stopped = Control()
    stopped.stop()
    found = Scripted([]).run(LINE, Options(start=TWO), stopped)
    assert (found.answer, found.objective, found.limit, found.statistics["start"]) == (TWO, 12.0, "interrupt", "used")


def test_what_no_limit_replaces_is_refused_by_name() -> None:
    engine = BACKENDS["pyvrp"]()
    base = small("capacity", 0, "round")
    assert engine.missing(asking(base, Reward() - 0.25 * Makespan())) == {"objective:makespan"}
    assert engine.missing(asking(base, -1.0 * LongestRoute())) == {"objective:longest-route"}
    assert engine.missing(asking(base, Makespan(), LongestRoute())) == {"objective:longest-route"}
    assert not Scripted([]).missing(LINE)
    assert Bisection.of(engine, base) is None  # type: ignore[arg-type]
