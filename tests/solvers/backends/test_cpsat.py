import itertools
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from coded import coded
from programs import program
from sata_cases import CASES
from truth.routing import best_values

import waybound as wb
from waybound import BottleneckSATA, InputError, UnsupportedError, UsageError, WinnerTakesAllSATA
from waybound.formulations.programs.circuits import Circuit
from waybound.solvers.backend import STATUSES, Control, Options
from waybound.solvers.backends import cpsat
from waybound.solvers.backends.cpsat import STATUS_MAP, CpSat

INF = math.inf


def run(p, control=None, **options):
    return CpSat().run(p, Options(**options), control or Control())


def test_every_status_of_cp_sat_has_one_of_ours():
    from ortools.sat.python import cp_model

    assert set(STATUS_MAP) == set(cp_model.CpSolverStatus.__members__)
    assert set(STATUS_MAP.values()) <= set(STATUSES)


def test_linear_programs_are_refused_with_those_who_take_them():
    with pytest.raises(UnsupportedError, match=r"LP programs; can take it: .*highs"):
        run(program([1], [[1]], 1, INF))


@pytest.mark.parametrize(
    ("p", "feature"),
    [
        (program([1, 1, 1], [[1, 2, 0], [2, 1, 1]], 3, INF, 0, 9, integer=[2]), "counted in steps"),
        (program([-1], [[1]], 0, INF, integer=[0]), "without bounds"),
    ],
)
def test_features_that_cannot_be_counted_are_refused_with_others_who_can(p, feature):
    with pytest.raises(UnsupportedError, match=rf"{feature}.*can take it: .*highs") as caught:
        run(p)
    assert "cpsat" not in caught.value.others


def test_the_scale_is_told():
    result = run(program([0.1, 1], [[1, 1]], 1, 3, 0, 3, integer=[0, 1]))
    assert result.statistics["scale"] == {"objective": 10.0, "exact": True}


def test_bounds_of_data_that_do_not_scale_are_rounded_outwards():
    rng = np.random.default_rng(0)
    for _ in range(30):
        n = 8
        weight, worth = rng.random(n), rng.random(n)
        p = program(worth, weight[None], -INF, weight.sum() / 2, 0, 1, integer=range(n), sense="max")
        result = run(p)
        points = np.array([[k >> j & 1 for j in range(n)] for k in range(2**n)], dtype=float)
        best = (points @ worth)[points @ weight <= weight.sum() / 2].max()
        assert result.status == "optimal"
        assert best - 1e-12 <= result.bound <= best + 1e-6
        assert result.objective == pytest.approx(best, abs=1e-6)


def test_an_empty_range_of_an_integer_is_infeasible():
    result = run(program([1], [[1]], -INF, INF, 0.2, 0.8, integer=[0]))
    assert (result.status, result.answer) == ("infeasible", None)
    assert "x0" in result.message


@pytest.mark.parametrize(
    ("extra", "code"),
    [
        ({"num_workers": 2}, "contradiction"), ({"max_time_in_seconds": 1}, "contradiction"), ({"no_such": 1}, "unknown-name"),
        ({"linearization_level": "much"}, "malformed"), ({"linearization_level": 2**40}, "out-of-range"),
    ],
)  # fmt: skip
def test_parameters_that_have_a_common_name_or_none_are_refused(extra, code):
    with pytest.raises(UsageError, check=coded(code)):
        run(program([1], [[1]], 0, 1, 0, 1, integer=[0]), extra=extra)


def test_parameters_that_would_make_claims_false_are_refused():
    with pytest.raises(UsageError, match="instantiate_all_variables"):
        run(program([1], [[1]], 0, 1, 0, 1, integer=[0]), extra={"instantiate_all_variables": False})


@pytest.mark.parametrize("extra", [{"linearization_level": "2"}, {"cp_model_presolve": "false"}, {"random_branches_ratio": "0.1"}])
def test_own_parameters_are_taken_as_text(extra):
    assert run(program([1, 1], [[2, 3]], 7, INF, 0, 9, integer=[0, 1]), extra=extra).objective == 3.0


def test_one_thread_repeats_to_the_bit():
    problem = WinnerTakesAllSATA(wb.generate("sata", robots=12, actions=3, targets=60, phi=8, seed=4, weights="uniform").graph)
    first, second = (run(problem.compile().program, seed=5, iterations=20) for _ in range(2))
    assert (first.answer == second.answer).all()
    assert first.statistics == second.statistics


def test_the_least_of_sums_is_counted_in_steps_of_the_weights():
    result = run(BottleneckSATA(CASES["S4a"].graph).compile().program)
    assert result.objective == pytest.approx(1.0)
    assert result.statistics["scale"]["exact"]


def test_a_start_that_is_no_number_anywhere_does_no_harm():
    p = program([5, 4], [[2, 3]], -INF, 5, 0, 9, integer=[0, 1], sense="max")
    assert run(p, start=np.full(2, np.nan)).objective == 10.0
    assert run(p, start=np.array([77.0, -3.0])).objective == 10.0


def test_products_of_integers_and_of_a_continuous_with_an_integer():
    # x in 0..3, y in -2..2: x y - y^2 - x at its largest and least.
    values = {(x, y): x * y - y * y - x for x in range(4) for y in range(-2, 3)}
    quadratic = [[0, 1], [1, -2]]
    for sense, best in (("max", max(values.values())), ("min", min(values.values()))):
        p = program([-1, 0], [[1, 1]], -INF, INF, [0, -2], [3, 2], integer=[0, 1], sense=sense, quadratic=quadratic)
        result = run(p)
        assert (result.status, result.objective, result.bound) == ("optimal", pytest.approx(best), pytest.approx(best))
    # u is continuous in [0, 2.5]: max x u - 2 x over u <= 4 - x.
    p = program([-2, 0], [[1, 1]], -INF, 4, 0, [3, 2.5], integer=[0], sense="max", quadratic=[[0, 1], [1, 0]])
    assert run(p).objective == pytest.approx(0.5)


def test_products_of_continuous_variables_are_refused():
    p = program([0, 0, 1], [[1, 1, 1]], -INF, 4, 0, 3, integer=[2], quadratic=[[0, 1, 0], [1, 0, 0], [0, 0, 0]])
    with pytest.raises(UnsupportedError, match="products of continuous"):
        run(p)


def test_numbers_too_large_for_64_bits_are_refused():
    with pytest.raises((UnsupportedError, InputError)):
        run(program([1, 1], [[1e17, 1]], 0, 1e18, 0, 1e6, integer=[0, 1]))


def test_routing_programs_whose_levels_are_differences_can_be_counted():
    from small_routing import small

    for convention in ("round", "exact"):
        problem = small("time-windows", 1, convention)
        for form in ("two-index-time-flow", "two-index-mtz"):
            result = run(problem.compile(form).program)
            assert result.objective == pytest.approx(best_values(problem)[0], abs=1e-6)


@pytest.mark.slow
def test_circuits_are_those_of_enumeration_whatever_is_fixed():
    """Random graphs of up to four nodes, arcs fixed to be used or not: one circuit with loops, or several without."""
    rng, statuses = np.random.default_rng(5), []
    for turn in range(40):
        several, nodes = bool(turn % 2), int(rng.integers(2, 5))
        pairs = [(i, j) for i in range(nodes) for j in range(nodes) if i != j or not several]
        m = min(len(pairs), int(rng.integers(nodes, 9)))
        ends = np.array([pairs[k] for k in rng.choice(len(pairs), m, replace=False)], dtype=np.int32).reshape(m, 2)
        used = (rng.random(m) < 0.1).astype(float)
        bare = program(rng.integers(-5, 6, m), np.zeros((0, m)), 0, 0, used, np.maximum(used, rng.random(m) < 0.9), integer=range(m))
        graph = Circuit("graph", nodes, ends[:, 0], ends[:, 1], np.arange(m, dtype=np.int32), several)
        p = replace(bare, circuits=(graph,))
        points = [np.array(x) for x in itertools.product((0.0, 1.0), repeat=m)]
        best = min((p.value(x) for x in points if p.residual(x) == 0.0), default=None)
        result = run(p)
        assert (result.status, result.objective) == (("infeasible", None) if best is None else ("optimal", best)), turn
        statuses.append(result.status)
    assert statuses.count("optimal") >= 8


def test_nodes_that_no_arc_names_are_not_forgotten():
    for nodes, status in ((2, "optimal"), (3, "infeasible")):
        arcs = np.array([0, 1], dtype=np.int32)
        p = program([1, 1], np.zeros((0, 2)), 0, 0, 0, 1, integer=[0, 1])
        for several in (False, True):
            assert run(replace(p, circuits=(Circuit("pair", nodes, arcs, arcs[::-1], arcs, several),))).status == status


@pytest.mark.parametrize(
    ("given", "conflicts", "asked", "limit"),
    [({}, 5, False, "time"), ({"iterations": 9}, 5, False, "time"), ({"iterations": 5}, 5, False, "nodes"), ({}, 5, True, "interrupt"),
     ({"extra": {"max_deterministic_time": 1.0}}, 5, False, "none")],
)  # fmt: skip
def test_what_ended_a_search_without_a_proof_is_named_though_its_clock_is_ahead_of_ours(given, conflicts, asked, limit) -> None:
    control = Control()
    if asked:
        control.stop()
    response = SimpleNamespace(
        status=SimpleNamespace(name="UNKNOWN"), num_conflicts=conflicts, num_branches=0, inner_objective_lower_bound=0.0, solution=[]
    )  # fmt: skip
    counted = SimpleNamespace(scale=1.0, exact=True, num_variables=0)
    assert cpsat._said(response, counted, Options(time_limit=10.0, **given), control, 1.0).limit == limit
