"""The four forms of selection problems against enumeration, each other, and their files."""

import itertools

import numpy as np
import pytest
from coded import check_coded
from draws import draws
from programs import AnsweredBy
from sata_cases import CASES, random_graph, selections
from selection_problems import CONSTRAINTS, cover_30, feasible_sets, optimum, random_problem

from waybound import BottleneckSATA, Exactness, InputError, MaxMinLP, Selection, SubmodularSelection, WinnerTakesAllSATA
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.sata.constraints import Cardinality, PartitionMatroid
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.instances.sata.set_functions import Coverage, FacilityLocation
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.linear_relaxation import linear_relaxation_bound
from waybound.solving.bounding import find_bounds

LINEAR = ("facility-location", "strong-linearisation", "weak-linearisation")
FUNCTIONS = ("coverage", "facility-location", "dense", "dense32")


def solved(program, via="highs", **extra):
    return BACKENDS[via]().run(program, Options(extra=extra), Control())


def random_problems(count: int, seed: int):
    """Every function under every constraint in turn."""
    rng = np.random.default_rng(seed)
    for k, (function, constraint) in zip(range(count), itertools.cycle(itertools.product(FUNCTIONS, CONSTRAINTS)), strict=False):
        yield random_problem(rng, function, constraint, most=7, whole=k % 3 == 0)


@pytest.mark.share(3)
@pytest.mark.parametrize("form", LINEAR)
def test_each_linear_form_agrees_with_enumeration_on_random_problems(form):
    for problem in random_problems(draws(200), seed=5):
        compiled = problem.compile(form)
        result = solved(compiled.program)
        assert result.status == "optimal"
        judged = problem.evaluate(compiled.decode(result.answer))
        assert judged.feasible
        assert judged.values[0] == pytest.approx(optimum(problem), abs=1e-6)
        assert result.objective == pytest.approx(judged.values[0], abs=1e-5)


def test_the_product_form_agrees_with_enumeration_on_random_problems():
    for problem in random_problems(draws(200), seed=6):
        compiled = problem.compile("product")
        result = solved(compiled.program, "cpsat")
        assert result.status == "optimal", result
        judged = problem.evaluate(compiled.decode(result.answer))
        assert judged.feasible
        assert judged.values[0] == pytest.approx(optimum(problem), abs=1e-6)


@pytest.mark.share(2)
@pytest.mark.share(2)
@pytest.mark.parametrize("form", [*LINEAR, "product"])
def test_robots_and_targets_agree_with_enumeration(form):
    rng = np.random.default_rng(7)
    for _ in range(50):
        problem = WinnerTakesAllSATA(random_graph(rng))
        compiled = problem.compile(form)
        result = solved(compiled.program, "cpsat" if form == "product" else "highs")
        best = max(problem.evaluate(s).values[0] for s in selections(problem.graph))
        assert problem.evaluate(compiled.decode(result.answer)).values[0] == pytest.approx(best, abs=1e-6)


@pytest.mark.slow
def test_the_relaxations_of_two_forms_are_equal_and_the_weak_one_is_no_better():
    for problem in random_problems(60, seed=8):
        values = {form: solved(problem.compile(form, relax=True).program).objective for form in LINEAR}
        assert values["facility-location"] == pytest.approx(values["strong-linearisation"], abs=1e-6)
        assert values["weak-linearisation"] >= values["strong-linearisation"] - 1e-6
        assert values["strong-linearisation"] >= optimum(problem) - 1e-6


@pytest.mark.slow
@pytest.mark.share(2)
@pytest.mark.parametrize("extra", [{}, {"solver": "simplex"}])
def test_prices_from_each_form_prove_its_relaxation_or_more(extra):
    for problem in random_problems(60, seed=9):
        for form in LINEAR:
            compiled = problem.compile(form, relax=True)
            program = compiled.program
            assert compiled.exactness is Exactness.RELAXATION
            result = solved(program, **extra)
            if result.row_duals is None:
                continue
            evidence = compiled.dual_evidence(result.row_duals)
            assert evidence.kind == "item-prices"
            assert len(evidence.data["prices"]) == problem.function.num_items
            bound = verified_bound(problem, evidence)
            slack = 1e-5 * max(1.0, abs(bound))  # a knapsack's budget may be exceeded by 1e-6
            assert optimum(problem) - 1e-9 <= bound <= solved(program).objective + slack


@pytest.mark.slow
def test_duals_of_an_interior_point_without_crossover_prove_nothing_false():
    for problem in random_problems(40, seed=9):
        for form in LINEAR:
            compiled = problem.compile(form, relax=True)
            duals = solved(compiled.program, solver="ipm", run_crossover="off").row_duals
            if duals is not None:
                assert compiled.dual_evidence(duals).value >= optimum(problem) - 1e-9


def test_negated_and_nonsense_duals_prove_nothing_false():
    rng = np.random.default_rng(10)
    for problem in random_problems(40, seed=11):
        best = optimum(problem)
        for form in LINEAR:
            compiled = problem.compile(form)
            program = compiled.program
            assert compiled.dual_evidence(rng.normal(size=program.num_rows)).value >= best - 1e-9
            assert compiled.dual_evidence(np.zeros(program.num_rows)).value >= best - 1e-9


@pytest.mark.parametrize("form", [*LINEAR, "product"])
def test_answers_become_points_of_their_value_and_come_back(form):
    for problem in random_problems(24, seed=12):
        compiled = problem.compile(form)
        program = compiled.program
        for chosen in itertools.islice(feasible_sets(problem), 12):
            point = compiled.encode(Selection(chosen))
            assert program.residual(point) <= 1e-6
            assert program.value(point) == pytest.approx(problem.value(chosen), abs=1e-9)
            assert compiled.decode(point) == Selection(chosen)


def test_credit_goes_to_groups_only_where_one_element_is_chosen():
    f = Coverage.from_sets([[0], [0], [0]], [5.0])
    two = SubmodularSelection(f, PartitionMatroid.of([0, 0, 1], [2, 1])).compile("product").program
    assert [two.variable_name(3 + k) for k in range(3)] == ["y[group 2,1]", "y[1,1]", "y[2,1]"]
    one = SubmodularSelection(f, Cardinality(1)).compile("product").program
    assert one.num_variables == 4
    assert solved(one, "cpsat").objective == 5.0
    assert solved(two, "cpsat").objective == 5.0


def test_names_are_those_of_robots_actions_and_targets():
    graph = graph_of_edges([0, 0, 1], [0, 1, 2], [0, 1, 1], [2.0, 3.0, 4.0], robots=["ann", "bob"], targets=["t", "u"])
    problem = WinnerTakesAllSATA(graph)
    program = problem.compile("weak-linearisation").program
    assert [program.variable_name(k) for k in (0, 3, 6)] == ["x[ann.1]", "y[ann,t]", "z[ann.1,t]"]
    assert program.row_name(0) == "robot[ann]"
    assert program.row_name(program.num_rows - 1) == "item[u]"
    levels = problem.compile("facility-location").program
    assert [levels.variable_name(3 + k) for k in range(3)] == ["u[t,1]", "u[u,1]", "u[u,2]"]
    assert levels.row_name(2) == "level[t,1]"


def test_items_that_nobody_serves_and_elements_that_serve_nothing_are_allowed():
    function = FacilityLocation(np.array([0, 0, 1], np.int32), np.array([1], np.int32), np.array([2.0]), 3)
    problem = SubmodularSelection(function, Cardinality(1))
    for form in (*LINEAR, "product"):
        compiled = problem.compile(form)
        result = solved(compiled.program, "cpsat" if form == "product" else "highs")
        assert result.objective == pytest.approx(2.0)
        assert compiled.decode(result.answer).elements == (1,)


def test_a_function_without_edges_is_zero():
    problem = SubmodularSelection(Coverage.from_sets([[], []], [1.0]), Cardinality(1))
    for form in LINEAR:
        compiled = problem.compile(form)
        program = compiled.program
        assert solved(program).objective == pytest.approx(0.0)
        assert compiled.dual_evidence(np.zeros(program.num_rows)).value >= 0.0


def test_user_functions_have_no_form():
    assert random_problem(np.random.default_rng(0), "user", "cardinality").forms() == []


def test_the_default_form_is_linear_and_the_product_is_last():
    problem = cover_30(3)
    assert problem.forms() == ["facility-location", "strong-linearisation", "weak-linearisation", "product"]
    assert problem.compile().form == "facility-location"


def test_fractional_points_choose_nothing():
    compiled = cover_30(3).compile()
    program = compiled.program
    check_coded(InputError, "out-of-range", compiled.decode, np.full(program.num_variables, 0.4))
    check_coded(InputError, "unknown-name", compiled.encode, Selection.of([99]))


@pytest.mark.parametrize("form", [*LINEAR, "product"])
def test_files_of_each_form_keep_its_optimum(form, tmp_path):
    import highspy

    program = WinnerTakesAllSATA(CASES["S3"].graph).compile(form).program
    for suffix in (".mps", ".lp"):
        path = tmp_path / f"{form}{suffix}"
        program.write(path)
        if form == "product":
            pyscipopt = pytest.importorskip("pyscipopt")
            model = pyscipopt.Model()
            model.hideOutput()
            model.readProblem(str(path))
            model.optimize()
            assert model.getObjVal() == pytest.approx(31.0)
            continue
        model = highspy.Highs()
        model.setOptionValue("output_flag", False)
        model.readModel(str(path))
        lp = model.getLp()
        assert (lp.num_col_, lp.num_row_) == (program.num_variables, program.num_rows)
        assert np.array(lp.col_cost_) == pytest.approx(program.cost)
        model.run()
        assert model.getInfo().objective_function_value == pytest.approx(31.0)


def test_max_min_files_keep_their_optimum(tmp_path):
    import highspy

    for fractional, value in ((False, 10.0), (True, 10.5)):
        program = BottleneckSATA(CASES["S3"].graph, fractional=fractional).compile().program
        for suffix in (".mps", ".lp"):
            path = tmp_path / f"max-min{suffix}"
            program.write(path)
            model = highspy.Highs()
            model.setOptionValue("output_flag", False)
            model.readModel(str(path))
            model.run()
            assert model.getInfo().objective_function_value == pytest.approx(value)


def test_the_bound_by_linear_relaxation_takes_every_new_family():
    graph = CASES["S6"].graph
    method = BOUNDS["linear-relaxation"]
    for problem, value in (
        (WinnerTakesAllSATA(graph), 4.0),
        (BottleneckSATA(graph, fractional=True), 1.2),
        (MaxMinLP(np.eye(2), [[1.0, 1.0], [1.0, 0.0]]), 1.0),
        (MaxMinLP([[1.0, 1.0]], np.eye(2), sense="min"), 2.0),
    ):
        assert not method.missing(problem)
        found = [e for e in find_bounds(problem, 10.0) if "LP" in e.source]
        assert found
        assert verified_bound(problem, found[-1]) == pytest.approx(value, abs=1e-6)


@pytest.mark.slow
def test_the_bound_by_linear_relaxation_passes_over_forms_that_are_not_linear(monkeypatch):
    problem = cover_30(4)
    monkeypatch.setattr(type(problem), "forms", lambda self: ["product", "strong-linearisation"])
    programs = []

    def duals(program, seconds):
        programs.append(program)
        return BACKENDS["highs"]().run(program, Options(), Control()).row_duals

    evidence = linear_relaxation_bound(problem, Stop(20.0), AnsweredBy(duals))
    assert [p.name for p in programs] == ["strong-linearisation"]
    assert evidence.value >= optimum(problem)
    monkeypatch.setattr(type(problem), "forms", lambda self: ["product"])
    assert linear_relaxation_bound(problem, Stop(20.0), AnsweredBy(duals)) is None
