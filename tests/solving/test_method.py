"""Which method answers: chosen, refused before it runs, or begun by a heuristic."""

import math
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import coded
from programs import program
from sata_cases import CASES

import waybound as wb
from waybound import BottleneckSATA, LatestReturn, Routes, RoutingProblem, UnsupportedError, UsageError, WinnerTakesAllSATA, solve
from waybound.formulations.forms import FORMS, nearest_form
from waybound.formulations.programs.program import CONES, INTEGERS, LINEAR, QUADRATIC
from waybound.formulations.routing.objective import TERMS, Composable, LongestRoute, Makespan, Objective, Reward, TotalCost, Vehicles
from waybound.heuristics.heuristic import HEURISTICS, Outcome
from waybound.instances.routing.features import FEATURES, UNASKED
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers import interrupts
from waybound.solvers.backend import BACKENDS, Control, Engine, Options, RawResult
from waybound.solvers.engines.routing.portfolio import Portfolio
from waybound.solvers.engines.routing.ruin_recreate import RuinRecreate
from waybound.solvers.program_backend import ProgramBackend, takers
from waybound.solving import method
from waybound.solving.method import default_run, missing_features, opened, opening_heuristic

S3 = CASES["S3"].graph


def test_the_features_that_a_form_declares_are_those_of_its_program() -> None:
    problems = [
        BottleneckSATA(S3), BottleneckSATA(S3, fractional=True), WinnerTakesAllSATA(S3),
        wb.MaxMinLP(np.eye(2), np.eye(2)), wb.MaxMinLP(np.eye(2), np.eye(2), sense="min"),
    ]  # fmt: skip
    for problem in problems:
        for form in problem.forms():
            assert FORMS[form].makes(problem) == problem.compile(form).program.features()


def test_a_linear_form_is_taken_where_none_is_named() -> None:
    solution = wb.solve(WinnerTakesAllSATA(S3), bound_time=0)
    assert (solution.solver, solution.form) == ("highs", "facility-location")


def test_the_form_decides_which_solver_is_taken() -> None:
    assert wb.solve(WinnerTakesAllSATA(S3), form="product", bound_time=0).objective == 31.0
    assert wb.solve(BottleneckSATA(S3), form="max-min", bound_time=0).solver == "highs"


@pytest.mark.slow
def test_a_relaxation_is_solved_as_a_linear_program() -> None:
    assert wb.solve(WinnerTakesAllSATA(S3), relax=True, bound_time=0).solver == "highs"
    assert wb.solve(BottleneckSATA(S3), "cvxpy:CLARABEL", relax=True, bound_time=0).bound == pytest.approx(10.0, abs=1e-6)


def test_a_compiled_program_finds_a_solver_of_its_kind() -> None:
    made = wb.solve(WinnerTakesAllSATA(S3).compile("product"), bound_time=0)
    assert (made.solver, [link.name for link in made.chain]) == ("highs", ["product", "linear-products"])
    miqp = program([0, 0], [[1, 1]], -math.inf, 2, 0, 1, integer=[0, 1], sense="max", quadratic=[[0, 1], [1, 0]])
    assert wb.solve(miqp, bound_time=0).objective == pytest.approx(1.0)
    wide = program([0, 0], [[1, 1]], -math.inf, 5, 0, 3, integer=[0, 1], sense="max", quadratic=[[0, 1], [1, 0]])
    made = wb.solve(wide, bound_time=0)  # neither is binary, so that there is no linear form
    assert made.solver in ("scip", "mathopt")
    assert made.objective == pytest.approx(6.0)


def test_a_solver_that_lacks_the_kind_is_listed_with_what_it_lacks() -> None:
    fractional = BottleneckSATA(S3, fractional=True)
    assert missing_features("cpsat", fractional) == (frozenset({"LP programs"}), ())
    assert missing_features("cpsat", BottleneckSATA(S3)) == (frozenset(), ("max-min",))
    forms = ("facility-location", "strong-linearisation", "weak-linearisation")
    assert missing_features("highs", WinnerTakesAllSATA(S3)) == (frozenset(), (*forms, "product"))
    assert missing_features("cpsat", WinnerTakesAllSATA(S3)) == (frozenset(), (*forms, "product"))


def test_a_solver_that_lacks_the_kind_refuses_and_names_others() -> None:
    with pytest.raises(UnsupportedError, match=r"cpsat cannot take this problem: it does not handle LP programs; can take it: .*highs"):
        wb.solve(BottleneckSATA(S3, fractional=True), "cpsat")
    with pytest.raises(
        UnsupportedError, match=r"mathopt:glop cannot take this problem: it does not handle MIQP programs; can take it: .*cpsat"
    ):
        wb.solve(WinnerTakesAllSATA(S3), "mathopt:glop", form="product")


def test_takers_are_installed_and_take_what_they_say() -> None:
    for features in (LINEAR, INTEGERS, QUADRATIC, INTEGERS | QUADRATIC, *({cone} for cone in CONES), CONES, CONES | QUADRATIC):
        assert takers(frozenset(features))
        for name in takers(frozenset(features)):
            base, _, variant = name.partition(":")
            backend = BACKENDS[base](variant) if variant else BACKENDS[base]()
            assert isinstance(backend, ProgramBackend)
            assert backend.able(frozenset(features))
    assert "highs" not in takers(LINEAR, "highs")
    assert takers(CONES | INTEGERS) == []


def asking(objective: Composable, **fleet: Any) -> RoutingProblem:
    xy = np.random.default_rng(1).uniform(0, 9, (4, 2))
    return RoutingProblem(Sites.of(range(4), demand=1), Travel("euclidean", xy), (VehicleType(2, 20.0, **fleet),), Objective.of(objective))


@pytest.mark.parametrize("objective", [Reward() + LongestRoute(), Reward() + 2 * LongestRoute()])
def test_a_refusal_names_what_the_nearest_form_lacks_and_nothing_that_forms_have(objective: Composable) -> None:
    """The longest route cannot be made longer by a linear program."""
    problem = asking(objective)
    for solver in ("highs", "cpsat", "pyvrp"):
        assert missing_features(solver, problem) == ({"objective:longest-route"}, ())
        with pytest.raises(
            UnsupportedError, match=rf"^{solver} cannot take this problem: it does not handle objective:longest-route; no installed"
        ):
            wb.solve(problem, solver)
    with pytest.raises(
        UnsupportedError, match=r"^no form can take this problem: the nearest, two-index-.*, does not handle objective:longest-route$"
    ):
        problem.compile()


def test_the_nearest_form_is_the_one_that_lacks_fewest() -> None:
    problem = replace(asking(Reward().then(Vehicles() - Makespan())), fleet=(VehicleType(2), VehicleType(1, name="other")))
    assert FORMS["two-index-mtz"].missing(problem) == {"heterogeneous-fleet", "objective:makespan"}
    assert nearest_form(problem) == ("three-index", {"objective:makespan"})


def test_the_nearest_solver_is_of_the_family_and_lacks_fewest() -> None:
    charged: dict[str, Any] = {"energy": Energy(99.0, charge="windows"), "committed": True}
    assert missing_features("pyvrp", asking(LongestRoute(), **charged))[0] == {"energy:windows", "committed-vehicles"}
    assert missing_features("saddle", asking(LongestRoute()))[0] == {"routing problems"}
    told = r"^no installed solver can take this problem: the nearest, portfolio, does not handle objective:1\*longest-route"
    with pytest.raises(UnsupportedError, match=told):
        wb.solve(asking(Reward() + LongestRoute(), **charged))


@pytest.mark.slow
def test_where_no_solver_takes_a_problem_the_heuristic_that_opens_it_does_and_others_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for engine in (Portfolio, RuinRecreate):
        monkeypatch.setattr(engine, "installed", classmethod(lambda cls: False))
    problem = asking(TotalCost(), max_duration=60.0)
    many = Sites.of(range(31), demand=1)
    xy = np.random.default_rng(1).uniform(0, 9, (31, 2))
    spread = Travel("euclidean", xy, variances=np.ones((31, 31)) - np.eye(31))
    asked = replace(problem, sites=many, travel=spread, team_risk=0.05)
    assert wb.solve(asked, time_limit=0.5, bound_time=0).solver == "safety-margins"
    with pytest.raises(UsageError, match=r"no form of \S+ is exact; name one of three-index-\S+, three-index-\S+$"):
        wb.solve(asked, start=[[k] for k in range(1, 31)])
    refusal = UnsupportedError("no installed solver", frozenset({"team-risk"}), ["safety-margins"], nearest="ortools")
    assert str(refusal).endswith("does not handle team-risk; heuristics that can: safety-margins")


def test_where_no_form_takes_a_problem_the_engines_that_do_are_named() -> None:
    xy = np.random.default_rng(1).uniform(0, 9, (13, 2))
    sites = Sites.of(range(13), windows={1: [(0, 20), (30, 50)]})
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(2, max_duration=90.0),), LatestReturn())
    with pytest.raises(
        UnsupportedError, match=r"^highs cannot take this problem: it does not handle several-windows; can take it: ortools"
    ):
        wb.solve(problem, "highs")


@pytest.mark.parametrize("solver", ["highs", "cpsat", "mathopt", "scip", "pulp", "cvxpy"])
def test_objectives_in_order_of_priority_are_taken_by_whoever_takes_a_form_of_each_level(solver: str) -> None:
    asked = asking(Vehicles().then(TotalCost()))
    forms = tuple(form for form in asked.forms() if form != "circuit" or solver == "cpsat")
    assert missing_features(solver, asked) == (frozenset(), forms)
    assert missing_features(solver, asking(TotalCost())) == (frozenset(), forms)


def test_all_that_forms_engines_and_heuristics_for_routing_declare_is_in_the_vocabulary_of_the_data() -> None:
    declared = set().union(
        *(form.features for form in FORMS.values() if form.family == "routing"),
        *(b.features for b in BACKENDS.values() if issubclass(b, Engine) and b.family == "routing"),
        *(h.features for h in HEURISTICS.values() if h.families == ("routing",)),
    )
    of_objectives = {*(f"objective:{name}" for name in TERMS), "objective:weights", "objective:priorities"}
    assert declared <= FEATURES.keys() | of_objectives
    assert FEATURES.keys() - UNASKED <= declared


def test_who_knows_circuits_is_given_them_where_it_can_count_them() -> None:
    assert wb.solve(asking(TotalCost()), "cpsat", bound_time=0.0).form == "circuit"
    assert wb.solve(asking(TotalCost()), "highs", bound_time=0.0).form == "two-index-load-flow"
    xy = np.array([(0, 0), (3, 4), (6, 8)], dtype=float)
    sites = Sites.of(range(3), ready=[0, 7, 30])
    waiting = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(2),), Objective.of(Makespan()))
    assert wb.solve(waiting, "cpsat", bound_time=0.0).form == "set-partitioning"


def test_a_missing_feature_names_solvers_that_have_it(square: RoutingProblem, engine_that: Any) -> None:
    engine = engine_that(lambda p, o, c: RawResult("unknown"))
    windows = replace(square, sites=replace(square.sites, due=np.array([100.0, 50.0, 50.0, 50.0, 50.0])))
    with pytest.raises(UnsupportedError, match=r"time-windows.*can take it: .*pyvrp"):
        solve(windows, engine)


def test_an_unknown_solver_is_named_with_the_choices(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match=r"unknown solver .cplex.; choose from .*highs"):
        solve(square, "cplex")


def test_without_any_solver_a_package_is_missing(square: RoutingProblem, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(method, "BACKENDS", {})
    with pytest.raises(UsageError, check=coded("missing-package")):
        method.default_solver(square)


def test_a_heuristic_checks_its_parameters(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match="savings has no option 'shap'; it takes shape"):
        solve(square, heuristic="savings", shap=2)


def test_a_variant_without_a_name_is_refused(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match="names no solver within pulp"):
        solve(square, "pulp:")


def test_a_large_program_is_searched_where_its_solver_can_be_ended(square: RoutingProblem, monkeypatch: pytest.MonkeyPatch) -> None:
    apart: list[Any] = []
    inside = method.run_in_process
    monkeypatch.setattr(method, "run_in_process", lambda work, *rest: apart.append(work.solver) or inside(work, *rest))
    before = solve(square, "highs", bound_time=0)
    assert not apart
    monkeypatch.setattr(method, "LARGE_PROGRAM", 0)
    assert solve(square, "highs", bound_time=0).objective == before.objective
    assert apart == ["highs"]


NAME = "safety-margins"
ALONE = Routes.of([[k] for k in range(1, 14)])


def star(risk: float | None = 0.1, customers: int = 13, team_risk: float | None = None) -> RoutingProblem:
    """Customers around a depot, two of which fit into a route."""
    angle = 2.0 * np.pi * np.arange(customers) / customers
    xy = np.concatenate([[[0.0, 0.0]], 10.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)])
    matrix = np.linalg.norm(xy[:, None] - xy[None], axis=2).round(3)
    vehicle = VehicleType(customers, risk=risk, max_duration=28.0)
    return RoutingProblem(
        Sites.of(range(customers + 1)), Travel(EXPLICIT, matrix=matrix, variances=matrix / 50), (vehicle,), team_risk=team_risk
    )


@contextmanager
def finding(answer: Any) -> Iterator[list[float]]:
    """``safety-margins`` with this answer, or this exception; tells the time limits that it was given."""
    limits: list[float] = []

    def run(problem: Any, context: Any) -> Outcome:
        limits.append(context.time_limit)
        if isinstance(answer, Exception):
            raise answer
        return Outcome(answer, message="" if answer else "no routes")

    with HEURISTICS.temporary(NAME, replace(HEURISTICS[NAME], run=run)):
        yield limits


def test_it_opens_problems_with_risks_and_more_than_a_few_customers() -> None:
    assert opening_heuristic(star(), Options()) == opening_heuristic(star(None, team_risk=0.2), Options()) == NAME
    assert opening_heuristic(star(customers=9), Options()) is None
    assert opening_heuristic(star(customers=12), Options()) is None, "all sets of sites are looked at"
    assert opening_heuristic(star(customers=6, risk=None, team_risk=0.2), Options()) is None
    assert opening_heuristic(replace(star(None), travel=replace(star().travel, variances=None)), Options()) is None
    for asked in ({"start": ALONE}, {"iterations": 5}, {"no_improvement": 5}, {"extra": {"presolve": False}}):
        assert opening_heuristic(star(), Options(**asked)) is None


def test_the_solver_gets_the_answer_and_the_time_that_is_left() -> None:
    with finding(ALONE) as limits:
        options, seconds, said = opened(star(), NAME, Options(time_limit=8.0, gap=0.1), isolate=False)
    assert (options.start, options.gap, said, limits) == (ALONE, 0.1, "", [4.0])
    assert options.time_limit == pytest.approx(8.0 - seconds)


@pytest.mark.slow
@pytest.mark.skipif(not BACKENDS["scip"].installed(), reason="SCIP is not installed")
def test_no_answer_is_worse_than_the_start() -> None:
    with finding(ALONE):
        found = solve(star(), time_limit=1.0, bound_time=0)
    assert found.answer is not None and found.objective <= 260.0
    assert f"{found.solver} started from the answer of {NAME}" in found.message


def test_a_program_begins_with_the_vector_of_the_answer_or_says_why_not(monkeypatch: pytest.MonkeyPatch) -> None:
    for engine in (Portfolio, RuinRecreate):
        monkeypatch.setattr(engine, "installed", classmethod(lambda cls: False))
    compiled, given = default_run(star(), Options(), isolate=False).compiled, list[Options]()
    assert compiled is not None
    for name in BACKENDS:
        monkeypatch.setattr(BACKENDS[name], "run", lambda self, program, options, control: given.append(options) or RawResult("unknown"))
    with finding(ALONE):
        found = solve(star(), time_limit=8.0, bound_time=0)
    assert (found.answer, compiled.decode(given[0].start)) == (ALONE, ALONE) and given[0].time_limit < 8.0
    with finding(Routes.of([range(1, 14)])):  # longer than any route may be
        found = solve(star(), time_limit=8.0, bound_time=0)
    assert given[1].start is None and "the start was not used: " in found.message


@pytest.mark.parametrize(("answer", "words"), [(None, "no routes"), (RuntimeError("lost"), "RuntimeError: lost")])
def test_without_a_start_the_solver_goes_on(answer: Any, words: str) -> None:
    with finding(answer):
        options, _, said = opened(star(), NAME, Options(), isolate=False)
    assert options.start is None and words in said


def test_large_problems_and_those_for_which_there_is_no_solver_are_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    with finding(ALONE) as limits:
        monkeypatch.setattr(Portfolio, "installed", classmethod(lambda cls: False))
        monkeypatch.setattr(RuinRecreate, "installed", classmethod(lambda cls: False))
        found = solve(star(None, 13, team_risk=0.2), time_limit=8.0, bound_time=0)
        assert (found.solver, found.status, limits) == (NAME, "feasible", [8.0])
        monkeypatch.setattr("waybound.solving.method.LARGEST_WRITTEN", 5)
        assert solve(star(), time_limit=8.0, bound_time=0).solver == NAME


def test_few_customers_with_too_many_routes_for_an_exact_form_begin_with_it() -> None:
    far = star(None, 13, team_risk=0.2)
    far = replace(far, fleet=(replace(far.fleet[0], max_duration=280.0),))
    assert "set-partitioning" not in far.forms()
    with finding(Routes.of([range(1, 14)])) as limits:
        found = solve(far, time_limit=1.0, bound_time=0)
    assert (found.solver, found.status, limits) == ("portfolio", "feasible", [0.5])


@pytest.mark.slow
def test_who_names_a_solver_or_a_form_gets_it_alone() -> None:
    with finding(RuntimeError("not asked")) as limits:
        for asked in ({"solver": "outer-approximation"}, {"form": "three-index-cones"}):
            solve(star(), time_limit=0.2, bound_time=0, **asked)
    assert not limits


class Deaf(Engine):
    """An engine that takes every problem before all others, and comes back when it is told to."""

    name, package, modules, summary = "deaf", "waybound", ("json",), "for tests"
    family, features, order = "routing", frozenset[str](), -1
    honours = frozenset({"iterations"})
    needed, seconds = 0.0, 0.0

    def missing(self, problem: Any) -> frozenset[str]:
        return frozenset() if problem.family == self.family else frozenset({"routes"})

    def memory(self, problem: Any) -> float:
        return self.needed

    def set_up_seconds(self, problem: Any) -> float:
        return self.seconds

    def run(self, problem: Any, options: Options, control: Control) -> RawResult:
        return RawResult("unknown")


@contextmanager
def default(**what: Any) -> Iterator[None]:
    """With ``Deaf`` as the default solver, changed like this."""
    with BACKENDS.temporary("deaf", type("Deaf", (Deaf,), what)):
        yield


def test_what_opens_is_judged_and_told_before_the_engine_begins() -> None:
    told: list[dict[str, Any]] = []
    known: list[Any] = []

    def run(self: Any, problem: Any, options: Options, control: Control) -> RawResult:
        control.begin_set_up()
        control.end_set_up(2.46)
        known.extend([options.start, [(e["phase"], e["objective"], e["found_by"]) for e in told if e["objective"] is not None]])
        return RawResult("unknown")

    with finding(ALONE), default(run=run):
        found = solve(star(), time_limit=8.0, bound_time=0, progress=told.append)
    assert known == [ALONE, [("check", 260.0, NAME)]]
    assert (found.answer, found.objective) == (ALONE, 260.0)
    assert f"deaf started from the answer of {NAME}, worth 260; deaf took 2.5 s to set up" in found.message


@pytest.mark.parametrize("signalled", [False, True])
def test_an_engine_that_never_comes_back_costs_no_answer_whether_the_clock_or_a_signal_ends_it(
    signalled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("waybound.solving.search.OVERTIME", 0.0)
    monkeypatch.setattr("waybound.solving.search.GRACE", 0.0)
    release = threading.Event()

    def run(self: Any, problem: Any, options: Options, control: Control) -> RawResult:
        control.begin_set_up()
        if signalled:
            interrupts.note()
        release.wait(60)
        return RawResult("feasible", answer=Routes.of([range(1, 14)]))

    try:
        with finding(ALONE), default(run=run):
            found = solve(star(), time_limit=600.0 if signalled else 0.01, bound_time=0)
    finally:
        release.set()
        interrupts.reset()
    assert (found.answer, found.objective, found.limit) == (ALONE, 260.0, "interrupt" if signalled else "time")
    assert "did not stop when asked while it was still setting up, and had published no answer" in found.message


def test_a_work_limit_is_the_engines_alone() -> None:
    starts: list[Any] = []

    def run(self: Any, problem: Any, options: Options, control: Control) -> RawResult:
        starts.append((options.start, options.time_limit))
        return RawResult("feasible", answer=ALONE)

    with finding(RuntimeError("not asked")) as limits, default(run=run):
        for _ in range(2):
            solve(star(), time_limit=8.0, bound_time=0, iterations=5)
    assert (starts, limits) == ([(None, 8.0)] * 2, [])


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ({"needed": 1e18}, "deaf needs 931,322,575 GiB for a problem of size 14, more than the "),
        ({"seconds": 9.0}, "it takes some 9 s to set up for a problem of size 14"),
    ],
)
def test_an_engine_without_the_memory_or_the_time_for_its_model_is_not_begun(what: dict[str, float], words: str) -> None:
    with finding(ALONE) as limits, default(**what):
        found = solve(star(), time_limit=8.0, bound_time=0)
        assert (found.solver, found.objective, limits) == (NAME, 260.0, [8.0])
        assert f"deaf was not used: {words}" in found.message
        if "needed" in what:
            with pytest.raises(UsageError, check=coded("too-large")):
                solve(star(), "deaf", time_limit=8.0, bound_time=0)


def scattered(customers: int) -> RoutingProblem:
    """Customers anywhere, some ten of which fit into a route."""
    rng = np.random.default_rng(customers)
    sites = Sites.of(range(customers + 1), demand=[0, *rng.integers(1, 10, customers)])
    return RoutingProblem(sites, Travel("euclidean", coordinates=rng.uniform(0, 1000, (customers + 1, 2))), (VehicleType(None, 50.0),))


def test_savings_open_where_engines_are_slow_to_begin() -> None:
    assert opening_heuristic(scattered(1_499), Options()) is None
    assert opening_heuristic(scattered(1_500), Options()) == "savings"
    assert opening_heuristic(scattered(1_500), Options(iterations=3)) is None


@pytest.mark.slow
@pytest.mark.skipif(not BACKENDS["pyvrp"].installed(), reason="PyVRP is not installed")
def test_thousands_of_customers_are_begun_by_savings_and_work_limits_repeat() -> None:
    problem = scattered(1_600)
    run = default_run(problem, Options(time_limit=60.0), isolate=False)
    assert (run.name, run.opening) == ("portfolio", "savings")
    once, again = (solve(problem, iterations=2, bound_time=0, time_limit=600.0) for _ in range(2))
    assert once.solver == "portfolio" and once.answer == again.answer and "savings" not in once.message
    assert once.statistics["iterations"] == 2
