import json

import numpy as np
import pytest
from coded import check_coded
from file_cases import check_refused
from hypothesis import given, strategies as st
from random_sensing import optimum
from sata_cases import matrices_of, random_graph
from truth.local_algorithm import random_graph as graph_of_robots

import waybound as wb
from waybound import BottleneckSATA, Evidence, UnsupportedError
from waybound.formulations.sata.max_min_lp import MaxMinLP, as_row_prices, as_sensing
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.writing import write_instance

seeds = st.integers(0, 2**32 - 1)
A, C = np.array([[1.0, 1, 0], [0, 0, 2]]), np.array([[1.0, 0, 1], [0, 3, 0]])


def program(sense="max", **options):
    return wb.MaxMinLP(A, C, sense=sense, **options)


@given(seeds, st.sampled_from(["max", "min"]))
def test_value_and_feasibility_are_those_of_the_matrices(seed, sense):
    rng = np.random.default_rng(seed)
    x = rng.uniform(-0.1, 1.2, 3) * rng.choice([0, 0.5, 1], 3)
    judged = program(sense).evaluate(x)
    packed, covered = A @ x, C @ x
    assert judged.values[0] == pytest.approx(covered.min() if sense == "max" else packed.max(), abs=1e-12)
    fits = (packed <= 1 + 1e-6).all() if sense == "max" else (covered >= 1 - 1e-6).all()
    assert judged.feasible is bool(fits and (x >= -1e-6).all())


def test_the_two_senses_are_each_others_reciprocal_at_proportional_points():
    x = np.array([0.5, 0.5, 0.5])
    best = program().evaluate(x)
    assert best.feasible and best.values == (1.0,)
    scaled = program("min").evaluate(x / best.values[0])
    assert scaled.feasible and scaled.values[0] == pytest.approx(1 / best.values[0])


@given(seeds)
def test_a_bottleneck_of_shares_is_the_program_with_one_packing_row_a_robot(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng)
    general, own = wb.MaxMinLP(*matrices_of(graph)), wb.BottleneckSATA(graph, fractional=True)
    assert general.one_packing_row
    x = rng.random(graph.num_actions)
    a, b = general.evaluate(x), own.evaluate(x)
    assert a.values == pytest.approx(b.values, abs=1e-12)
    assert a.feasible == b.feasible


@given(seeds, st.floats(1e-3, 1e3))
def test_scaled_covering_rows_scale_the_value_and_relabelling_changes_nothing(seed, factor):
    rng = np.random.default_rng(seed)
    x, order = rng.random(3), rng.permutation(3)
    before = program().evaluate(x).values[0]
    assert wb.MaxMinLP(A, factor * C).evaluate(x).values[0] == pytest.approx(factor * before, rel=1e-12)
    assert wb.MaxMinLP(A[:, order], C[:, order]).evaluate(x[order]).values[0] == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize(
    ("sense", "x", "says"),
    [
        ("max", [0.6, 0.6, 0], "packing row 1 is broken, by 0.2"),
        ("min", [1, 0.25, 0], "covering row 2 is broken, by 0.25"),
        ("max", [0, -0.5, 0], "variable b is -0.5, not 0 or more"),
        ("max", [np.nan, 0, 0], "variable a is nan, not 0 or more"),
        ("min", [np.inf, 1, 1], "variable a is inf, not 0 or more"),
    ],
)
def test_faults_are_told_by_name(sense, x, says):
    judged = program(sense, variable_names=("a", "b", "c")).evaluate(x)
    assert says in [v.message for v in judged.violations]


@pytest.mark.parametrize("answer", [[1, 2], "x", None, [[1, 2, 3]], [1, 2, "a"]])
def test_another_sort_of_answer_is_a_usage_error(answer):
    with pytest.raises(wb.UsageError, match="an answer to max-min-lp is a vector of 3 numbers"):
        program().evaluate(answer)


def test_features_tell_sense_and_structure():
    assert program().features() == {"packing-covering"}
    assert program("min").features() == {"packing-covering", "min-max"}
    assert wb.MaxMinLP(np.ones((2, 3)), C).features() == {"packing-covering", "several-packing-rows"}
    assert wb.MaxMinLP(np.vstack([A, [0, 0, 0]]), C).one_packing_row


def test_matrices_that_do_not_fit_are_refused():
    check_coded(wb.InputError, "wrong-shape", wb.MaxMinLP, A, C[:, :2])
    check_coded(wb.InputError, "out-of-range", wb.MaxMinLP, A, -C)
    check_coded(wb.InputError, "unknown-name", program, "most")


@given(st.lists(st.floats(0, 1e12), min_size=3, max_size=3))
def test_answers_survive_json(x):
    problem = program(variable_names=("a", "b", "c"))
    assert problem.answer_from_json(json.loads(json.dumps(problem.answer_to_json(x)))).tolist() == x


@pytest.mark.parametrize(
    ("data", "says"),
    [
        ({"kind": "vector", "values": [1]}, "not an answer to a max-min LP"),
        ({"kind": "values", "values": [1]}, "not an answer to a max-min LP"),
        ({"kind": "values", "values": {"4": 1}}, "the answer names an unknown variable '4'"),
        ({"kind": "values", "values": {"1": "much"}}, "the value of variable 1 is not a number"),
        ({"kind": "values", "values": {"1": True}}, "the value of variable 1 is not a number"),
    ],
)
def test_a_file_that_is_no_answer_is_refused(data, says):
    with pytest.raises(wb.InputError, match=says):
        program().answer_from_json(data)


def test_the_frame_has_a_row_for_each_variable_in_use():
    assert program().answer_to_frame([0.5, 0, 1e-9]).to_dict("list") == {"variable": ["1", "3"], "value": [0.5, 1e-9]}


def test_a_file_holds_the_whole_program(tmp_path):
    problem = program("min", name="small", variable_names=("a", "b", "c"))
    write_instance(problem.instance, tmp_path / "p.json")
    again = wb.read(tmp_path / "p.json")
    assert isinstance(again, wb.MaxMinLP)
    assert (again.digest(), again.sense, again.variable_name(2), again.name) == (problem.digest(), "min", "c", "small")
    check_refused(wb.UsageError, "max-min-lp has no setting 'k'", wb.read, tmp_path / "p.json", k=3)
    check_coded(wb.UsageError, "foreign", wb.read, tmp_path / "p.json", problem="bottleneck")


# -- one packing row a variable ---------------------------------------------------------------------------------------


def scaled_problem(rng: np.random.Generator) -> tuple[MaxMinLP, BottleneckSATA, np.ndarray]:
    """A bottleneck problem, and the same with every column scaled."""
    graph = graph_of_robots(rng)
    a, c = matrices_of(graph)
    scale = rng.uniform(0.2, 5.0, graph.num_actions)
    return MaxMinLP(a * scale, c * scale), BottleneckSATA(graph, fractional=True), scale


@given(st.integers(0, 10**6))
def test_values_and_feasibility_carry_over(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem, robots, _ = scaled_problem(rng)
    graph, scale = as_sensing(problem)
    seeing = np.diff(graph.indptr) > 0
    shares = rng.dirichlet(np.ones(graph.num_actions)) * seeing
    x = shares / scale
    assert problem.evaluate(x).values[0] == pytest.approx(robots.evaluate(shares).values[0], abs=1e-12)
    assert problem.evaluate(x).feasible == BottleneckSATA(graph, fractional=True).evaluate(shares).feasible
    assert optimum(graph) == pytest.approx(optimum(robots.graph), abs=1e-8)


@given(st.integers(0, 10**6))
def test_evidence_for_the_robots_proves_the_same_for_the_program(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem, _, _ = scaled_problem(rng)
    graph, _ = as_sensing(problem)
    targets = rng.permutation(graph.num_targets)[: int(rng.integers(1, graph.num_targets + 1))]
    evidence = Evidence("target-weights", "test", 0.0, {"targets": targets.tolist(), "weights": rng.uniform(0.1, 1, len(targets)).tolist()})
    bound = verified_bound(BottleneckSATA(graph, fractional=True), evidence)
    assert verified_bound(problem, as_row_prices(graph, evidence)) == pytest.approx(bound, rel=1e-9)
    assert bound >= optimum(graph) * (1 - 1e-9)


def test_variables_that_cover_nothing_may_stand_in_any_packing_rows_and_are_zero() -> None:
    problem = MaxMinLP([[2, 1, 0, 0], [0, 1, 4, 0]], [[1, 0, 0, 0], [0, 0, 2, 0]])
    assert problem.features() == {"packing-covering"}
    graph, scale = as_sensing(problem)
    assert scale.tolist() == [2.0, np.inf, 4.0, np.inf]
    assert (np.ones(4) / scale).tolist() == [0.5, 0.0, 0.25, 0.0]
    assert graph.indptr.tolist() == [0, 1, 1, 2, 2]
    assert graph.weights.tolist() == [0.5, 0.5]


def test_other_programs_are_refused_by_what_they_have() -> None:
    check_refused(UnsupportedError, "several-packing-rows", as_sensing, MaxMinLP([[1.0], [1.0]], [[1.0]]))
    check_refused(UnsupportedError, "min-max", as_sensing, MaxMinLP([[1.0]], [[1.0]], sense="min"))


def test_of_coefficients_too_far_apart_the_extreme_ones_are_named_and_what_to_do():
    said = r"\(1 in covering and 1 in packing of variable 1, and 1e\+200 in covering and 1e-200 in packing of variable 2\); divide all"
    check_refused(UnsupportedError, said, as_sensing, MaxMinLP([[1.0, 1e-200]], [[1.0, 1e200]]))
