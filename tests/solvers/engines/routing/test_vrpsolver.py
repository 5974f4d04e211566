import importlib.machinery
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from coded import coded
from small_routing import plane, simplified, small, varied
from truth.routing import best_values

import waybound as wb
from waybound import Penalties, Route, Routes, RoutingProblem, Sites, TotalCost, Travel, VehicleType
from waybound.instances.errors import InputError, MissingPackageError, UnsupportedError
from waybound.instances.routing.travel import EXPLICIT
from waybound.reports.benchmarks.routing_variants import drawn
from waybound.solvers.backend import BACKENDS, Control, Options, solver_named
from waybound.solvers.engines.routing import vrpsolver
from waybound.solvers.engines.routing.portfolio import ENGINES
from waybound.solvers.engines.routing.routing_integers import integer_routing
from waybound.solvers.engines.routing.vrpsolver import Model, Reader, VRPSolver, last_words, library
from waybound.solving.method import default_solver

needs_library = pytest.mark.skipif(not BACKENDS["vrpsolver"].installed(), reason="not installed: pip install VRPSolverEasy==0.1.3")


def model(problem: RoutingProblem) -> Model:
    return Model(problem, integer_routing(problem))


def line(*at: float, **sites) -> RoutingProblem:
    """Sites along a line, the depot at its beginning."""
    places = np.array([0.0, *at])
    travel = Travel(EXPLICIT, matrix=np.abs(places[:, None] - places))
    return RoutingProblem(Sites.of(range(len(places)), **sites), travel, (VehicleType(),))


# -- who gets it -------------------------------------------------------------------------------------------------------------


def test_who_lacks_it_is_told_the_version_that_has_an_engine(monkeypatch) -> None:
    monkeypatch.setattr(vrpsolver, "library", lambda: None)
    with pytest.raises(MissingPackageError, match=r"pip install VRPSolverEasy==0\.1\.3"):
        solver_named("vrpsolver")


def test_a_wheel_without_the_engine_is_not_enough(monkeypatch, tmp_path: Path) -> None:
    spec = importlib.machinery.ModuleSpec("VRPSolverEasy", None, is_package=True)
    spec.submodule_search_locations = [str(tmp_path)]
    monkeypatch.setattr("importlib.util.find_spec", lambda name: spec)
    monkeypatch.setattr("platform.system", lambda: "Linux")
    assert library() is None
    file = tmp_path / "lib" / "Linux" / "libbapcod-shared.so"
    file.parent.mkdir(parents=True)
    file.touch()
    assert library() == file
    monkeypatch.setattr("platform.system", lambda: "Plan 9")
    assert library() is None


def test_nobody_gets_it_unasked(monkeypatch) -> None:
    monkeypatch.setattr(VRPSolver, "installed", lambda: True)
    monkeypatch.setattr(VRPSolver, "order", -1)
    assert default_solver(small("capacity", 0, "round")) == "portfolio"
    assert VRPSolver not in ENGINES


# -- what it takes -----------------------------------------------------------------------------------------------------------


def test_what_it_does_not_model_is_refused_by_name() -> None:
    engine, waits = VRPSolver(), line(3, 5, ready=[0, 9, 0])
    limited = replace(waits, fleet=(VehicleType(max_duration=20.0),))
    assert engine.missing(limited) == {"max-duration with waiting"}
    assert not engine.missing(replace(line(3, 5), fleet=limited.fleet))
    assert engine.missing(replace(waits, fleet=(VehicleType(max_distance=20.0),))) == {"max-distance with limits of time"}
    assert engine.missing(line(*range(1, 1100))) == {"more than 1022 sites"}
    assert engine.missing(replace(line(3), objective=TotalCost().then(Penalties()))) == {"objective:total-cost before others"}
    with pytest.raises(UnsupportedError, match="max-duration with waiting"):
        engine.run(limited, Options(), Control())


def test_costs_beyond_what_doubles_tell_apart_are_refused_with_the_number() -> None:
    with pytest.raises(InputError, match="at most 1000000000; found 4000000001", check=coded("out-of-range")):
        model(replace(line(1000, 1000), fleet=(VehicleType(unit_cost=1e6),)))


def test_a_start_is_a_value_to_stay_below() -> None:
    asked = model(small("capacity", 0, "round"))
    start = Routes.of(Route((site,)) for site in asked.problem.customers.tolist())
    before = asked.cutoff
    assert asked.begin(start)
    assert asked.cutoff == asked.problem.evaluate(start).values[0] + 1 < before
    assert not model(asked.problem).begin(Routes.of([asked.problem.customers.tolist()] * 2))
    assert not model(asked.problem).begin(Routes.of([Route((99,))]))


def test_sites_that_earn_nothing_may_be_left_out() -> None:
    asked = model(line(3, 5, 9, required=[False, True, False, False]))
    assert (asked.idle, asked.steps) == (2, 3)
    assert asked.begin(Routes.of([[1]])) and asked.cutoff == 3 * 6 + 2 + 1
    assert asked.bound(18.0) == 6.0  # an answer of 5 costs 17 at most
    assert asked.bound(17.0) == asked.bound(16.0) == 5.0


# -- what it says ------------------------------------------------------------------------------------------------------------


def test_the_cutoff_is_no_bound() -> None:
    asked = model(small("time-windows", 0, "trunc1"))
    assert asked.bound(float(asked.cutoff)) is asked.bound(1e12) is asked.bound(-1e12) is None
    assert asked.bound(123.4) == 12.4 and asked.bound(123.0000001) == asked.bound(122.99999) == 12.3
    assert asked.bound(130.0, cost=129) is None


def test_bounds_are_read_from_what_is_printed() -> None:
    reader = Reader()
    assert reader.bound(b"ColGenEvalAlg final dual bound: 11337.5 (rounded: 11338)") == 11338
    assert reader.bound(b"<DWph=0> <it= 3> <DB=16362.5000> <PB=13553> ") is None
    assert reader.bound(b"ColGenEvalAlg final dual bound: 18425.1 (rounded: 18426)") == 13553
    assert reader.bound(b"**** Strong branching phase 1 is started *****") is None
    assert reader.bound(b"ColGenEvalAlg final dual bound: 11337.5 (rounded: 11338)") is None  # of one node
    assert reader.bound(b"Search is finished, global bounds : [ 11439 , 13553 ], TIME = 0h0m30s10t = 3010") == 11439
    assert reader.bound(b"**** Local DB = 70, global bounds : [ 71 , 90 ], TIME") == 71
    assert 1.23456e6 - 7 < (Reader().bound(b"global bounds : [ 1.23457e+06 , 2e+06 ]") or 0.0) < 1234565.1  # six digits


def test_last_words_are_those_of_an_error(tmp_path: Path) -> None:
    file = tmp_path / "printed"
    assert last_words(file) == ""
    file.write_text("Model is built\nRCSP error: it is buggy! 1\n")
    assert last_words(file) == "RCSP error: it is buggy! 1"
    file.write_text("error\n<DWph=0> <it= 3>\n")
    assert last_words(file) == ""


def said(status: int, *, bound: float = 0.0, value: float = 0.0, routes=(), message: str = "said", start: Routes | None = None, nodes=1):
    """A result of the wrapper for a solution of the library with this status and these figures."""
    asked = model(small("capacity", 0, "round"))
    if start is not None:
        assert asked.begin(start)
    statistics = SimpleNamespace(best_lb=bound, root_lb=bound, nb_branch_and_bound_nodes=nodes)
    solution = SimpleNamespace(value=value, routes=routes)
    made = SimpleNamespace(
        set_parameters=lambda **given: None, solve=lambda: None, status=status, message=message, statistics=statistics, solution=solution
    )
    return asked.solved(made, 1.0)


@needs_library
def test_words_of_the_library_become_ours() -> None:
    alone = Routes.of(Route((site,)) for site in small("capacity", 0, "round").customers.tolist())
    ways = [SimpleNamespace(point_ids=[0, number, 0], vehicle_type_id=1) for number in range(1, 1 + len(alone))]
    worth = small("capacity", 0, "round").evaluate(alone).values[0]
    proved = said(0, bound=worth, value=worth - 4e-10, routes=ways)
    assert (proved.status, proved.limit, proved.objective, proved.bound, proved.answer) == ("optimal", "none", worth, worth, alone)
    assert "root bound" not in said(0, bound=2 * worth, value=worth, routes=ways).statistics  # once an answer closes the node
    found = said(1, bound=10.2, value=worth, routes=ways)
    assert (found.status, found.limit, found.objective, found.bound) == ("feasible", "time", worth, 11.0)
    nothing = said(3, bound=10.2)
    assert (nothing.status, nothing.limit, nothing.bound, nothing.answer) == ("unknown", "time", 11.0, None)
    for none in (said(2, bound=1e6), said(-2), said(-8, message="... not enough to cover the total demand of ... customers.")):
        assert (none.status, none.limit, none.bound, none.answer) == ("infeasible", "none", None, None)
    assert said(3, bound=1e6).bound is None
    assert (said(2, nodes=0).status, said(2, nodes=0).limit) == ("unknown", "time")  # it had no time for a node
    assert (said(-1).status, said(-1).message) == ("error", "VRPSolver says: said")
    kept = said(2, bound=1e6, start=alone)
    assert (kept.status, kept.objective, kept.bound) == ("feasible", worth, None)


# -- the library itself ------------------------------------------------------------------------------------------------------


@needs_library
def test_windows_end_with_the_service() -> None:
    made = model(line(3, 5, ready=[0, 2, 0], due=[99, 9, 20], service=[0, 4, 1])).made()
    assert [(p.tw_begin, p.tw_end, p.service_time) for p in (made.points[1], made.points[2])] == [(2, 13, 4), (0, 21, 1)]


@needs_library
@pytest.mark.parametrize(("skewed", "count"), [(0.0, 6), (1.0, 12)])
def test_links_are_all_for_both_ways_or_all_for_one(skewed: float, count: int) -> None:
    problem = line(3, 5, 9)
    matrix = problem.travel.distances.copy()
    matrix[1, 2] += skewed
    links = model(replace(problem, travel=Travel(EXPLICIT, matrix=matrix))).made().links
    assert len(links) == count and {links[pair][0].is_directed for pair in links} == {bool(skewed)}


@needs_library
def test_ways_that_differ_keep_their_costs() -> None:
    problem = simplified(varied("skills", 3, 4), "skills", VRPSolver().missing)
    assert problem is not None
    result = VRPSolver().run(problem, Options(), Control())
    assert result.objective == problem.evaluate(result.answer).values[0] == best_values(problem)[0]


@needs_library
def test_its_optimum_and_bound_stay_claims(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    solution = wb.solve(plane(3, 8, 20.0), "vrpsolver", bound_time=0)
    assert (solution.status, solution.bound_kind, solution.bound) == ("optimal", "claimed", solution.objective)
    assert solution.certificate.bound is None and solution.certificate.feasible
    assert not solution.faults
    assert not [*tmp_path.iterdir()]  # the library writes a file where it is


@needs_library
def test_it_finds_the_known_optimum_of_a_file(benchmarks: Path) -> None:
    problem = wb.read(benchmarks / "vrptw-solomon" / "R101.txt", convention="dimacs", customers=25)
    started = wb.solve(problem, "pyvrp", iterations=20, bound_time=0)
    solution = wb.solve(problem, "vrpsolver", start=started.answer, bound_time=0)
    assert solution.objective == solution.bound == pytest.approx(617.1)
    assert solution.statistics["start"] == "used"


@needs_library
def test_where_no_route_can_reach_a_site_there_is_no_answer_and_no_bound() -> None:
    problem = line(3, 5, due=[99, 2, 9])
    assert "no vehicle can serve 1" in VRPSolver().run(problem, Options(), Control()).message
    packed = replace(line(3, 5, 9, demand=[0, 4, 4, 4]), fleet=(VehicleType(2, 7.0),))
    solution = wb.solve(packed, "vrpsolver", bound_time=0)
    assert (solution.status, solution.bound, solution.answer) == ("infeasible", None, None)


@needs_library
def test_a_limit_leaves_the_start() -> None:
    problem = plane(1, 150, 60.0)
    alone = Routes.of(Route((site,)) for site in problem.customers.tolist())
    result = VRPSolver().run(problem, Options(time_limit=0.3, start=alone), Control())
    assert (result.status, result.limit, result.answer) == ("feasible", "time", alone)


@needs_library
def test_a_crash_is_told_in_a_line() -> None:
    solution = wb.solve(drawn(7, 396), "vrpsolver", bound_time=0)
    assert (solution.status, solution.answer) == ("error", None)
    assert solution.message == "the solver's process ended with code 1: RCSP error: construction of rank-1 cut rowset is buggy! 1"
