import threading
from typing import Any

import numpy as np
import pytest
from oracles import OCTO_8, routing
from programs import AnsweredBy, Counting, Patient, program
from random_sensing import optimum, random_graph

from waybound import BottleneckSATA, Compiled, MissingPackageError, UnsupportedError, UsageError, WayboundError
from waybound.formulations.programs.program import LINEAR, Program, Rows, Variables
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.backend import BACKENDS, LP_SOLVER
from waybound.solvers.backends.scip import Scip
from waybound.solvers.bounds.linear_relaxation import linear_relaxation_bound
from waybound.solvers.bounds.routing.sifted_relaxation import sifted_relaxation_bound
from waybound.solvers.linear_programs import LinearPrograms, linear_programs
from waybound.solvers.program_backend import ProgramBackend, takers

SILENT = ("mathopt:gscip", "pulp:HiGHS")
"""They tell no row duals."""

SOLVERS = [*takers(LINEAR), "pulp:HiGHS"]
PRICING = [name for name in SOLVERS if name not in SILENT]
OTHERWISE_LONG = ("cvxpy:SCS", "cvxpy:ECOS", "cvxpy:HIGHS")
SMALL = program([3, 5], [[1, 0], [0, 2], [3, 2]], -np.inf, [4, 12, 18], sense="max")


def by_name(names: list[str]) -> Any:
    return pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.long) if n in OTHERWISE_LONG else n for n in names])


def cover(size: int) -> Program:
    """Cover every row at least cost; dense, so that it takes its time."""
    rng = np.random.default_rng(0)
    x = Variables("x", lower=np.zeros(size), upper=np.full(size, np.inf), cost=1.0 + rng.random(size))
    rows = Rows(
        "need", indptr=np.arange(size + 1, dtype=np.int32) * size, indices=np.tile(np.arange(size, dtype=np.int32), size),
        data=rng.random(size * size), lower=np.ones(size), upper=np.full(size, np.inf),
    )  # fmt: skip
    return Program("cover", "min", (x,), (rows,))


@pytest.fixture(scope="module")
def relaxations() -> list[tuple[Compiled, float]]:
    """A max-min LP and the relaxation of a routing problem, with their values."""
    graph = random_graph(3)
    routes = routing(xy=OCTO_8, count=2, max_distance=40.0, sites={"demand": 1.0}, capacity=5).compile("two-index-time-flow", relax=True)
    value = LinearPrograms().solve(routes.program).objective
    assert value is not None
    return [(BottleneckSATA(graph, fractional=True).compile(), optimum(graph)), (routes, value)]


# -- the same bounds --------------------------------------------------------------------------------------------------


def test_all_that_take_linear_programs_are_tried_here() -> None:
    assert set(PRICING) >= {"highs", "pulp", "mathopt:glop", "mathopt:pdlp", "mathopt:highs", "cvxpy:CLARABEL", "cvxpy:SCS", "cvxpy:HIGHS"}
    assert ("scip" in PRICING) == Scip.installed()


@pytest.mark.share(3)
@by_name(PRICING)
def test_row_duals_prove_the_value_whoever_tells_them(name: str, relaxations: list[tuple[Compiled, float]]) -> None:
    for made, value in relaxations:
        assert made.dual_evidence is not None
        duals = LinearPrograms(name).duals(made.program)
        assert duals is not None and duals.shape == (made.program.num_rows,)
        assert verified_bound(made.problem, made.dual_evidence(duals)) == pytest.approx(value, rel=1e-6)


@pytest.mark.share(2)
@by_name(["highs", "pulp", "mathopt:glop", "mathopt:highs"])
def test_the_bound_of_a_problem_is_the_same_whoever_solves_its_relaxation(name: str, relaxations: list[tuple[Compiled, float]]) -> None:
    for made, value in relaxations:
        bound = sifted_relaxation_bound if made.problem.family == "routing" else linear_relaxation_bound
        evidence = bound(made.problem, Stop(60.0), LinearPrograms(name))  # type: ignore[arg-type]
        assert evidence is not None
        assert verified_bound(made.problem, evidence) == pytest.approx(value, rel=1e-6)


@by_name(list(SILENT))
def test_those_who_tell_no_duals_solve_and_prove_nothing(name: str) -> None:
    assert LinearPrograms(name).solve(SMALL).objective == pytest.approx(36.0)
    assert LinearPrograms(name).duals(SMALL) is None


# -- ends when asked to -----------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.share(3)
@pytest.mark.parametrize(
    "name",
    ["highs", "scip", "pulp", *(pytest.param(n, marks=pytest.mark.long) for n in ("mathopt:glop", "mathopt:highs", "cvxpy:CLARABEL"))],
)
def test_a_wish_to_stop_from_another_thread_ends_the_program_that_runs(name: str) -> None:
    if name not in SOLVERS:
        pytest.skip(f"{name} is not installed")
    hard, stop = cover(1000), Stop(120.0)
    threading.Timer(0.2, stop.ask).start()
    result = LinearPrograms(name).solve(hard, stop)
    assert (result.status, result.limit, result.answer) == ("unknown", "interrupt", None)


def test_a_wish_reaches_the_program_through_every_part_of_the_stop(registered: Any) -> None:
    registered(BACKENDS, "patient", Patient)
    for part in (lambda stop: stop.within(60.0), lambda stop: stop.after(60.0)):
        stop = Stop(60.0)
        threading.Timer(0.1, stop.ask).start()
        assert LinearPrograms("patient").solve(SMALL, part(stop)).limit == "interrupt"


def test_a_stop_that_was_asked_before_begins_nothing(registered: Any) -> None:
    registered(BACKENDS, "counting", Counting)
    Counting.told.clear()
    stop = Stop()
    stop.ask()
    assert LinearPrograms("counting").duals(SMALL, stop) is None
    assert LinearPrograms("counting").duals(SMALL, Stop(0.0)) is None
    assert not Counting.told


def test_a_deadline_is_the_time_limit(registered: Any) -> None:
    registered(BACKENDS, "patient", Patient)
    Patient.told.clear()
    assert LinearPrograms("patient").solve(SMALL, Stop(0.2)).limit == "time"
    assert all(told.time_limit <= 0.2 for told in Patient.told)


# -- what a solver is told --------------------------------------------------------------------------------------------


def test_seed_and_threads_reach_the_solver(registered: Any) -> None:
    registered(BACKENDS, "counting", Counting)
    assert LinearPrograms("counting", seed=7, threads=2).duals(SMALL) is not None
    options = Counting.told[-1][1]
    assert (options.seed, options.threads) == (7, 2)


def test_options_that_suit_one_solver_are_told_to_that_one_alone(registered: Any) -> None:
    registered(BACKENDS, "counting", Counting)
    made = LinearPrograms("counting")
    made.solve(SMALL, suits={"highs": {"solver": "ipm"}, "counting": {"solver": "simplex"}}, iterations=50)
    assert (Counting.told[-1][1].extra, Counting.told[-1][1].iterations) == ({"solver": "simplex"}, 50)
    made.solve(SMALL, suits={"highs": {"solver": "ipm"}}, iterations=50)
    assert (Counting.told[-1][1].extra, Counting.told[-1][1].iterations) == ({}, None)


@pytest.mark.parametrize("duals", [np.array([np.nan, 0.0, 0.0]), np.array([np.inf, 0.0, 0.0]), None])
def test_duals_that_are_no_numbers_are_none(duals: Any) -> None:
    assert AnsweredBy(lambda *_: duals).duals(SMALL) is None


# -- names that are of no use -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "error", "words"),
    [
        ("hihgs", UsageError, "unknown solver 'hihgs'; choose from .*cvxpy, .*highs"),
        ("highs:fast", UsageError, "highs:fast does not exist"),
        ("mathopt:", UsageError, "names no solver within mathopt"),
        ("pyvrp", UnsupportedError, "pyvrp cannot take this problem: it does not handle LP programs; can take it: .*highs"),
        ("cpsat", UnsupportedError, "cpsat cannot take this problem: it does not handle LP programs"),
        ("mathopt:cp-sat", UnsupportedError, "mathopt:cp-sat cannot take this problem: it does not handle LP programs"),
    ],
)
def test_who_solves_no_linear_programs_is_refused_in_one_line(name: str, error: type[WayboundError], words: str) -> None:
    for call in (lambda: linear_programs(name), lambda: LinearPrograms(name).solve(SMALL)):
        with pytest.raises(error, match=words) as found:
            call()
        assert "\n" not in str(found.value)


def test_who_is_not_installed_is_refused_with_what_installs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Scip, "modules", ("no_such_package",))
    with pytest.raises(MissingPackageError, match="pip install pyscipopt"):
        linear_programs("scip")


def test_the_default_is_looked_for_when_it_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert isinstance(LinearPrograms().backend(), ProgramBackend)
    assert linear_programs(None, 3, 2) == LinearPrograms(LP_SOLVER, 3, 2)
    monkeypatch.setattr(BACKENDS[LP_SOLVER], "modules", ("no_such_package",))
    unchecked = linear_programs(None)
    with pytest.raises(MissingPackageError):
        unchecked.solve(SMALL)
    with pytest.raises(MissingPackageError):
        linear_programs(LP_SOLVER)
