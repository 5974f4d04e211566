"""Every routing engine: each feature it declares against enumeration, limits, starts, interrupts, and data with fractions."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from oracles import optimum as first_level_optimum, small_problems
from patience import HANG
from small_routing import FEATURES, small
from truth.routing import best_values

from waybound import LongestRoute, Route, Routes, RoutingProblem, Sites, TotalCost, UnsupportedError, UsageError, Vehicles, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.isolation import run_isolated

WORK = {"portfolio": 200, "pyvrp": 200, "ortools": 300, "ruin-recreate": 3000}
"""Enough of each engine's own iterations for five customers."""

FINEST = {"vroom": 10_000, "vrpsolver": 1_000}
"""Scale of fractions in engines of few digits; 1,000,000 in all others."""

BUSY = {"vroom": 400, "vrpsolver": 300}
"""Customers that keep an engine busy for some seconds; 60 all others."""

PROVERS = ("vrpsolver",)
"""Engines that end with an optimum, by their own account, and hand out no answer before."""

CERTAIN = (*PROVERS, "branch-price-cut")
"""Engines that may claim an optimum."""

UNSCALED = ("branch-price-cut",)
"""Engines that judge the data as they are."""

AGREE = 1e-6


def run(engine: str, problem, control=None, **options):
    options.setdefault("time_limit", 5.0)
    return BACKENDS[engine]().run(problem, Options(**options), control or Control())


def answered(engine: str, problem, seconds: float, control=None):
    """A run of a few moments; of longer ones where a busy machine leaves it without an answer."""
    for limit in (seconds, 20 * seconds, HANG):
        result = run(engine, problem, control, time_limit=limit)
        if result.answer is not None:
            break
    return result


def until_feasible(problem: RoutingProblem) -> Control:
    """A control that has enough of a search once it has a feasible answer."""
    control = Control()
    control.goal = lambda answer, objective: problem.evaluate(answer).feasible
    return control


def middling(customers: int = 60, convention: str = "exact", seed: int = 0) -> RoutingProblem:
    """A problem with time windows that takes an engine more than a moment."""
    rng = np.random.default_rng(seed)
    n = customers + 1
    xy = rng.uniform(0, 100, (n, 2))
    ready = np.append(0.0, rng.uniform(0, 400, customers))
    due = np.append(1000.0, ready[1:] + rng.uniform(80, 200, customers))
    sites = Sites.of(
        range(n), demand=np.append(0.0, rng.uniform(1, 20, customers)), ready=ready, due=due,
        service=np.append(0.0, np.full(customers, 7.3)), coordinates=xy,
    )  # fmt: skip
    return RoutingProblem(sites, Travel("euclidean", xy, convention=convention), (VehicleType(capacity=100.0),), problem="vrptw")


def soon_answered(engine: str, customers: int, convention: str = "exact") -> RoutingProblem:
    """The same with fewer customers for an engine that has no answer before it has proved the best."""
    return middling(customers // 2 if engine in PROVERS else customers, convention)


@pytest.mark.parametrize("name", [name for name in BACKENDS if getattr(BACKENDS[name], "family", "") == "routing"])
def test_an_engine_that_is_not_installed_is_not_tested_here(name):
    if not BACKENDS[name].installed():
        pytest.skip(f"{name} is not installed (pip install {BACKENDS[name].requirement()}): nothing here tests it")


DRAWN = [("round", 0), ("trunc1", 1), ("exact", 2)]


@pytest.mark.share(2)
@pytest.mark.parametrize(
    ("feature", "convention", "seed"),
    [pytest.param(f, *d, marks=() if (k + m) % 2 == 0 else pytest.mark.long) for k, f in enumerate(FEATURES) for m, d in enumerate(DRAWN)],
)
def test_each_declared_feature_gives_the_optimum_of_small_problems(engine_name, feature, convention, seed):
    problem = small(feature, seed, convention)
    if BACKENDS[engine_name]().missing(problem):
        pytest.skip(f"{engine_name} does not declare what {feature} needs")
    best = best_values(problem)
    result = run(engine_name, problem, iterations=WORK.get(engine_name, 200))
    if best is None:
        assert result.answer is None or not problem.evaluate(result.answer).feasible
        return
    verdict = problem.evaluate(result.answer)
    assert verdict.feasible, verdict.violations
    assert verdict.values == pytest.approx(best, abs=AGREE)
    if result.objective is not None:
        assert result.objective == pytest.approx(verdict.values[0], abs=1e-5)


@pytest.mark.share(2)
@pytest.mark.parametrize("hetero", [False, True])
def test_engines_agree_with_enumeration_on_any_mix_of_features(engine_name, hetero):
    engine = BACKENDS[engine_name]()

    @settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True, database=None)
    @given(small_problems(most=4, hetero=hetero))
    def agree(problem):
        if engine.missing(problem):
            return
        best = first_level_optimum(problem)
        # OR-Tools looks for an answer as long as it may where there is none.
        result = run(engine_name, problem, iterations=WORK.get(engine_name, 200), time_limit=5)
        if best is None:
            assert result.answer is None or not problem.evaluate(result.answer).feasible
            assert result.status in ("unknown", "infeasible")
            return
        assert result.status in ("feasible", "optimal"), result
        verdict = problem.evaluate(result.answer)
        assert verdict.feasible, verdict.violations
        # A heuristic may miss the optimum, but never beat it.
        gain = best - verdict.values[0] if problem.sense == "min" else verdict.values[0] - best
        assert gain <= AGREE
        if result.objective is not None:
            assert result.objective == pytest.approx(verdict.values[0], abs=1e-5)

    agree()


@pytest.mark.share(3)
@pytest.mark.parametrize("convention", ["exact", "trunc1", "trunc2", "round"])
def test_fractional_data_give_feasible_answers_of_the_value_told(engine_name, convention):
    problem = soon_answered(engine_name, 25, convention)
    result = answered(engine_name, problem, 0.15)
    verdict = problem.evaluate(result.answer)
    assert verdict.feasible, verdict.violations
    assert result.objective == pytest.approx(verdict.objective, abs=1e-4)
    if engine_name in UNSCALED:
        return
    # demands and windows with all their decimals
    assert result.statistics["scale"]["time"] >= FINEST.get(engine_name, 1_000_000)
    assert result.statistics["scale"]["exact"] is False


def test_data_with_one_decimal_are_scaled_exactly(engine_name):
    if engine_name in UNSCALED:
        pytest.skip(f"{engine_name} scales nothing")
    scale = run(engine_name, small("time-windows", 0, "trunc1"), iterations=20).statistics["scale"]
    assert scale["distance"] == 10
    assert scale["exact"] is True


def test_fractions_that_truncation_would_lose_are_kept(engine_name):
    # Truncated to integers all distances are 0, all loads fit, and any tour costs nothing.
    xy = np.array([[0, 0], [0.4, 0], [0.8, 0], [0, 0.4], [0, 0.8]])
    sites = Sites.of(range(5), demand=[0, 0.6, 0.6, 0.6, 0.6], coordinates=xy)
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(capacity=1.2),))
    result = run(engine_name, problem, iterations=WORK.get(engine_name, 200))
    assert problem.evaluate(result.answer).feasible
    assert result.objective == pytest.approx(3.2)


def needs_iterations(engine_name):
    if "iterations" not in BACKENDS[engine_name]().honours:
        pytest.skip(f"{engine_name} counts no iterations")


@pytest.mark.share(3)
def test_repeated_without_a_clock_it_comes_out_the_same(engine_name):
    if "iterations" in BACKENDS[engine_name]().honours:
        pytest.skip(f"{engine_name} repeats itself by iterations")
    first, second = (run(engine_name, soon_answered(engine_name, 30), time_limit=60, threads=threads) for threads in (1, 2))
    assert first.limit == second.limit == "none"
    assert first.answer == second.answer


def test_iterations_repeat_to_the_bit(engine_name):
    needs_iterations(engine_name)
    problem = middling(30)
    first, second = (run(engine_name, problem, iterations=60, time_limit=60, seed=3) for _ in range(2))
    assert first.limit == second.limit == "iterations"
    assert first.answer == second.answer


@pytest.mark.share(3)
def test_a_time_limit_is_named(engine_name):
    problem = middling(BUSY.get(engine_name, 60))
    result = run(engine_name, problem, time_limit=0.5) if engine_name in PROVERS else answered(engine_name, problem, 0.5)
    assert (result.status, result.limit) == ("unknown" if engine_name in PROVERS else "feasible", "time")


def test_whichever_limit_comes_first_is_named(engine_name):
    needs_iterations(engine_name)
    assert run(engine_name, middling(), time_limit=0.3, iterations=10**7).limit == "time"
    assert run(engine_name, middling(20), time_limit=60, iterations=5).limit == "iterations"


def test_no_optimum_is_claimed(engine_name):
    if engine_name in CERTAIN:
        pytest.skip(f"{engine_name} claims optima")
    result = run(engine_name, small("capacity", 0, "round"), iterations=50)
    assert result.status == "feasible"
    assert result.bound is None


@pytest.mark.share(3)
def test_an_interrupt_in_mid_run_keeps_the_best_answer(engine_name):
    problem, kind, answered = middling(BUSY.get(engine_name, 60)), BACKENDS[engine_name], threading.Event()
    control = Control(lambda event: answered.set())

    def interrupt() -> None:
        answered.wait(HANG)
        time.sleep(0.5)
        control.stop()

    threading.Thread(target=interrupt, daemon=True).start()
    if engine_name in PROVERS:
        answered.set()
    if kind.needs_process:
        result = run_isolated(engine_name, problem, Options(time_limit=120), control)
    else:
        result = run(engine_name, problem, control, time_limit=120)
    if engine_name in PROVERS:
        assert (result.status, result.limit) == ("unknown", "interrupt")
        return
    assert (result.status, result.limit) == ("feasible", "interrupt")
    assert problem.evaluate(result.answer).feasible


@pytest.mark.share(3)
def test_incumbents_are_published_in_order_and_are_feasible(engine_name):
    problem, seen = soon_answered(engine_name, 40), []
    control = Control(lambda event: seen.append(event["objective"]))
    result = answered(engine_name, problem, 0.3, control)
    assert seen == sorted(seen, reverse=True)
    assert problem.evaluate(control.answer).feasible
    assert result.objective <= seen[-1] + 1e-9


@pytest.mark.share(3)
def test_a_start_is_never_made_worse(engine_name):
    problem = soon_answered(engine_name, 40)
    good = answered(engine_name, problem, 0.3)
    again = run(engine_name, problem, start=good.answer, iterations=3)
    assert again.statistics["start"] == "used"
    assert again.objective <= good.objective + 1e-6


def test_an_infeasible_start_does_no_harm(engine_name):
    problem = small("capacity", 0, "round")
    tour = Routes.of([problem.customers.tolist()])
    assert not problem.evaluate(tour).feasible
    result = run(engine_name, problem, start=tour, iterations=WORK.get(engine_name, 200))
    verdict = problem.evaluate(result.answer)
    assert verdict.feasible
    assert verdict.values == pytest.approx(best_values(problem))


def test_a_start_for_another_fleet_is_refused_not_crashed_on(engine_name):
    problem = small("limited-fleet", 0, "round")
    alone = Routes.of([[c] for c in problem.customers.tolist()])
    result = run(engine_name, problem, start=alone, iterations=WORK.get(engine_name, 200))
    assert result.statistics["start"] == "refused"
    assert problem.evaluate(result.answer).values == pytest.approx(best_values(problem))


@pytest.mark.parametrize("routes", [[Route((99,))], [Route((-1,))], [Route((0,))], [Route((1, 2), 7)]])
def test_a_start_for_other_sites_or_vehicles_is_refused_not_crashed_on(engine_name, routes):
    problem = small("limited-fleet", 0, "round")
    result = run(engine_name, problem, start=Routes.of(routes), iterations=WORK.get(engine_name, 200))
    assert result.status != "error"
    assert problem.evaluate(result.answer).values == pytest.approx(best_values(problem))


def test_a_problem_without_customers_is_solved_by_staying_at_home(engine_name):
    xy = np.zeros((1, 2))
    problem = RoutingProblem(Sites.of(["depot"], coordinates=xy), Travel("euclidean", xy), (VehicleType(),))
    result = run(engine_name, problem)
    assert (result.status, result.objective, len(result.answer)) == ("optimal", 0.0, 0)


def test_demand_beyond_the_fleet_leaves_no_answer(engine_name):
    problem = small("capacity", 1, "round")
    problem = replace(problem, fleet=(replace(problem.fleet[0], count=1, capacity=10.0),))
    assert best_values(problem) is None
    result = run(engine_name, problem, iterations=50, time_limit=2)
    assert result.status in ("unknown", "infeasible")
    assert result.answer is None
    assert result.message


def test_a_depot_that_closes_before_it_opens_elsewhere_is_infeasible(engine_name):
    xy = np.array([[0, 0], [1, 0], [2, 0]], dtype=float)
    sites = Sites.of(range(3), depot=[True, True, False], ready=[50, 0, 0], due=[90, 20, 90], coordinates=xy)
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(start=0, end=1),))
    assert run(engine_name, problem).status == "infeasible"


def test_a_fleet_that_only_a_good_packing_fits_is_used(engine_name):
    # Five vehicles of 10 for 6,4,7,3,5,5,8,2,9,1: every vehicle is full, and greedy insertions fail.
    rng = np.random.default_rng(1)
    loads = np.array([0, 6, 4, 7, 3, 5, 5, 8, 2, 9, 1], dtype=float)
    xy = rng.integers(0, 50, (11, 2)).astype(float)
    problem = RoutingProblem(Sites.of(range(11), demand=loads, coordinates=xy), Travel("EUC_2D", xy), (VehicleType(5, 10.0),))
    result = run(engine_name, problem, until_feasible(problem), time_limit=HANG)
    assert result.answer is not None
    assert problem.evaluate(result.answer).feasible


def test_negative_ready_times_and_tight_windows(engine_name):
    xy = np.array([[0, 0], [3, 4], [6, 8]], dtype=float)
    sites = Sites.of(range(3), ready=[-20, -15, -10], due=[40, -15, -10], coordinates=xy)
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(),))
    result = run(engine_name, problem, iterations=50)
    assert problem.evaluate(result.answer).feasible
    assert result.objective == pytest.approx(20.0)


@pytest.mark.parametrize("power", [-200, -30, -10, 10, 47, 200])
def test_numbers_of_any_size_are_counted_in_integers(engine_name, power):
    xy = np.ldexp(np.array([[0.0, 0.0], [3.0, 4.0], [6.0, 8.0], [0.0, 7.5]]), power)
    load = np.ldexp([0.0, 1.0, 1.0, 1.5], -power)
    fleet = (VehicleType(capacity=float(np.ldexp(2.5, -power))),)
    problem = RoutingProblem(Sites.of(range(4), coordinates=xy, demand=load), Travel("euclidean", xy), fleet)
    judged = problem.evaluate(run(engine_name, problem, iterations=50).answer)
    assert judged.feasible
    assert judged.values[0] == pytest.approx(float(np.ldexp(27.5 + np.hypot(6.0, 0.5), power)), rel=1e-5)


def test_unknown_options_are_refused_with_the_close_ones(engine_name):
    with pytest.raises(UsageError, match="no option 'first_solution_stratgy'"):
        run(engine_name, small("capacity", 0, "round"), extra={"first_solution_stratgy": "SAVINGS"})


def test_objectives_beyond_its_terms_are_refused_by_name(engine_name):
    problem = small("capacity", 0, "round")
    for objective, word in (
        (LongestRoute(), "objective:longest-route"),
        (TotalCost().then(Vehicles()), "before others|objective:priorities"),
    ):
        asked = replace(problem, objective=objective)
        if word in BACKENDS[engine_name].features:
            continue
        with pytest.raises(UnsupportedError, match=word):
            run(engine_name, asked)


def test_a_real_fleet_of_unlimited_vehicles_may_be_as_large_as_needed(engine_name):
    # Every customer needs a vehicle of its own: more than an estimate from the loads would give.
    n = 41
    rng = np.random.default_rng(2)
    xy = rng.integers(0, 50, (n, 2)).astype(float)
    due = np.append(1000.0, np.full(n - 1, 80.0))
    sites = Sites.of(
        range(n), demand=np.append(0.0, np.ones(n - 1)), due=due, service=np.append(0.0, np.full(n - 1, 100.0)), coordinates=xy
    )
    problem = RoutingProblem(sites, Travel("EUC_2D", xy), (VehicleType(capacity=100.0),))
    result = run(engine_name, problem, until_feasible(problem), time_limit=HANG)
    assert problem.evaluate(result.answer).feasible
    assert len(result.answer) == n - 1
