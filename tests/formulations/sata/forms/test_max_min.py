import numpy as np
import pytest
from coded import check_coded, coded
from program_text import expected, written
from random_sensing import optimum
from sata_cases import CASES, best_value, dense_weights, random_graph, selections

from waybound import BottleneckSATA, Exactness, InputError, MaxMinLP, Selection, UnsupportedError, UsageError
from waybound.formulations.programs.program import LINEAR
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.backend import BACKENDS, Control, Options


def solved(program, **extra):
    result = BACKENDS["highs"]().run(program, Options(extra=extra), Control())
    assert result.status == "optimal"
    return result


@pytest.mark.slow
def test_whole_actions_agree_with_enumeration_on_random_graphs():
    rng = np.random.default_rng(0)
    for _ in range(200):
        problem = BottleneckSATA(random_graph(rng))
        compiled = problem.compile()
        best = max(problem.evaluate(s).values[0] for s in selections(problem.graph))
        result = solved(compiled.program)
        assert result.objective == pytest.approx(best, abs=1e-6)
        assert problem.evaluate(compiled.decode(result.answer)).values[0] == pytest.approx(best, abs=1e-6)


@pytest.mark.share(3)
@pytest.mark.parametrize("algorithm", [{}, {"run_crossover": "off"}, {"solver": "simplex"}])
def test_shares_agree_with_scipy_and_their_duals_prove_it(algorithm):
    rng = np.random.default_rng(1)
    for _ in range(60):
        graph = random_graph(rng, robots=4, actions=9, targets=5)
        problem = BottleneckSATA(graph, fractional=True)
        compiled, known = problem.compile(), optimum(graph)
        result = BACKENDS["highs"]().run(compiled.program, Options(extra=algorithm), Control())
        judged = problem.evaluate(compiled.decode(result.answer))
        assert judged.feasible
        assert judged.values[0] == pytest.approx(known, abs=1e-6)
        evidence = compiled.dual_evidence(result.row_duals)
        assert known - 1e-9 <= verified_bound(problem, evidence) <= known + 1e-6
        assert evidence.kind == "target-weights"
        assert all(w > 0 for w in evidence.data["weights"])


def test_evidence_of_shares_bounds_whole_actions_too():
    known = CASES["S3"]
    relaxed = BottleneckSATA(known.graph).compile(relax=True)
    assert relaxed.program.features() == LINEAR
    assert relaxed.exactness is Exactness.RELAXATION
    evidence = relaxed.dual_evidence(solved(relaxed.program).row_duals)
    assert verified_bound(BottleneckSATA(known.graph, fractional=True), evidence) == pytest.approx(10.5)
    assert verified_bound(BottleneckSATA(known.graph), evidence) == pytest.approx(10.0)  # whole weights have whole sums


def test_negated_duals_are_the_same_evidence():
    compiled = BottleneckSATA(CASES["S7"].graph, fractional=True).compile()
    duals = solved(compiled.program).row_duals
    one, other = compiled.dual_evidence(duals), compiled.dual_evidence(-duals)
    assert one.data["targets"] == other.data["targets"]
    assert one.data["weights"] == pytest.approx(other.data["weights"])


def test_nonsense_duals_prove_nothing_false():
    rng = np.random.default_rng(2)
    for _ in range(50):
        graph = random_graph(rng)
        compiled = BottleneckSATA(graph, fractional=True).compile()
        value = compiled.dual_evidence(rng.normal(size=compiled.program.num_rows)).value
        assert value >= optimum(graph) - 1e-9


def test_a_relaxed_point_is_no_selection():
    compiled = BottleneckSATA(CASES["S6"].graph).compile(relax=True)
    with pytest.raises(InputError, check=coded("out-of-range")):
        compiled.decode(solved(compiled.program).answer)


@pytest.mark.parametrize("fractional", [False, True])
def test_answers_become_points_of_their_value_and_come_back(fractional):
    rng = np.random.default_rng(3)
    for _ in range(20):
        graph = random_graph(rng)
        problem = BottleneckSATA(graph, fractional=fractional)
        compiled = problem.compile()
        program = compiled.program
        for answer in list(selections(graph))[:20]:
            shares = np.zeros(graph.num_actions)
            shares[list(answer.elements)] = 1.0
            given = shares if fractional else answer
            point = compiled.encode(given)
            assert program.residual(point) <= 1e-9
            assert program.value(point) == pytest.approx(problem.evaluate(given).values[0])
            back = compiled.decode(point)
            assert (back == shares).all() if fractional else set(back.elements) == set(answer.elements)


def test_starts_of_another_shape_are_refused():
    problem = BottleneckSATA(CASES["S1"].graph, fractional=True)
    check_coded(InputError, "wrong-shape", problem.compile().encode, np.ones(2))
    check_coded(InputError, "unknown-name", BottleneckSATA(CASES["S1"].graph).compile().encode, Selection.of([77]))
    check_coded(InputError, "wrong-shape", MaxMinLP(np.eye(2), np.eye(2)).compile().encode, np.ones(3))


def test_shares_that_exceed_a_row_by_a_tolerance_are_pulled_back():
    problem = BottleneckSATA(CASES["S8"].graph, fractional=True)
    shares = problem.compile().decode(np.array([1.0 + 3e-6, -4e-6, 1.0]))
    judged = problem.evaluate(shares)
    assert judged.feasible
    assert all(c.residual <= 1e-12 for c in judged.checks)


def test_idle_robots_and_unseen_targets_make_the_value_zero():
    graph = graph_of_edges([0, 2], [0, 0], [0, 2], robots=4, targets=4)
    for fractional in (False, True):
        compiled = BottleneckSATA(graph, fractional=fractional).compile()
        program = compiled.program
        assert (program.num_rows, program.num_variables) == (8, 3)
        result = solved(program)
        assert result.objective == 0.0
        if fractional:
            assert compiled.dual_evidence(result.row_duals).value == pytest.approx(0.0, abs=1e-9)


def test_a_graph_without_actions_can_be_written_down():
    program = BottleneckSATA(graph_of_edges([], [], [], robots=2, targets=3)).compile().program
    assert program.num_variables == 1
    assert solved(program).objective == 0.0


def test_names_are_those_of_the_graph():
    graph = graph_of_edges([0, 0, 1], [0, 1, 2], [0, 1, 1], robots=["ann", "bob"], targets=["t", "u"])
    program = BottleneckSATA(graph).compile().program
    assert [program.variable_name(k) for k in range(4)] == ["x[ann.1]", "x[ann.2]", "x[bob.1]", "w"]
    assert [program.row_name(k) for k in range(4)] == ["robot[ann]", "robot[bob]", "target[t]", "target[u]"]
    matrix = MaxMinLP(np.eye(2), np.ones((1, 2)), variable_names=("a", "b")).compile().program
    assert [matrix.variable_name(k) for k in range(3)] == ["x[a]", "x[b]", "w"]
    assert [matrix.row_name(k) for k in range(3)] == ["packing[1]", "packing[2]", "covering[1]"]


def test_rows_are_those_of_the_formulas():
    known = CASES["S1w"]
    program = BottleneckSATA(known.graph).compile().program
    dense = program.matrix.toarray()
    assert (dense[3:, :6] == dense_weights(known.graph).T).all()
    assert (dense[3:, 6] == -1).all()
    assert (dense[:3, 6] == 0).all()
    assert (dense[:3, :6] == np.repeat(np.eye(3), 2, axis=1)).all()
    assert program.integer.tolist() == [True] * 6 + [False]


@pytest.mark.share(2)
@pytest.mark.share(3)
@pytest.mark.parametrize("sense", ["max", "min"])
@pytest.mark.parametrize("algorithm", [{}, {"run_crossover": "off"}, {"solver": "simplex"}])
def test_packing_and_covering_rows_agree_with_scipy_and_are_proved(sense, algorithm):
    rng = np.random.default_rng(4)
    for _ in range(40):
        n, rows, targets = 7, 4, 5
        a = rng.uniform(0.2, 2, (rows, n)) * (rng.random((rows, n)) < 0.5)
        c = rng.uniform(0.2, 2, (targets, n)) * (rng.random((targets, n)) < 0.5)
        a[0, a.sum(axis=0) == 0], c[c.sum(axis=1) == 0, 0] = 1.0, 1.0
        problem = MaxMinLP(a, c, sense=sense)
        compiled = problem.compile()
        program = compiled.program
        known = best_value(problem)
        result = BACKENDS["highs"]().run(program, Options(extra=algorithm), Control())
        judged = problem.evaluate(compiled.decode(result.answer))
        assert judged.feasible
        assert judged.values[0] == pytest.approx(known, abs=1e-6)
        bound = verified_bound(problem, compiled.dual_evidence(result.row_duals))
        assert bound == pytest.approx(known, abs=1e-5)
        assert bound >= known - 1e-9 if sense == "max" else bound <= known + 1e-9


def test_answers_of_packing_and_covering_become_points_of_their_value():
    a, c = np.array([[1.0, 2.0], [0.5, 0.0]]), np.array([[1.0, 0.0], [1.0, 3.0]])
    for sense, x in (("max", np.array([0.4, 0.3])), ("min", np.array([1.5, 0.2]))):
        problem = MaxMinLP(a, c, sense=sense)
        compiled = problem.compile()
        program = compiled.program
        point = compiled.encode(x)
        assert program.residual(point) <= 1e-12
        assert program.value(point) == pytest.approx(problem.evaluate(x).values[0])
        assert compiled.decode(point) == pytest.approx(x)


def test_there_is_one_form_and_no_other_family_takes_it():
    problem = BottleneckSATA(CASES["S1"].graph)
    assert problem.forms() == ["max-min"]
    with pytest.raises(UnsupportedError):
        problem.compile("strong-linearisation")
    with pytest.raises(UsageError, match="unknown form"):
        problem.compile("no-such-form")


# -- from text to text ------------------------------------------------------------------------------------------------

ROBOTS = """
    # problem: {}
    robot,action,target,weight
    r,left,t,5
    r,right,u,3
    s,stay,t,2
    s,stay,u,1
"""


@pytest.mark.parametrize(
    ("problem", "domain"),
    [("bottleneck", "x[left], x[right], x[stay] binary"), ("bottleneck-lp", "0 <= x[left], x[right], x[stay] <= 1")],
)
def test_max_min_from_text_to_text(problem, domain, tmp_path):
    assert written(ROBOTS.format(problem), "max-min", tmp_path) == expected(
        f"""
        max-min, exact
        max w
        robot[r]: x[left] + x[right] <= 1
        robot[s]: x[stay] <= 1
        target[t]: 5 x[left] + 2 x[stay] - w >= 0
        target[u]: 3 x[right] + x[stay] - w >= 0
        {domain}
        w >= 0
        """
    )


MATRICES = """
    {"waybound": 1, "kind": "max-min", "name": "tiny", "problem": "max-min-lp", "sense": "%s", "variables": ["a", "b"],
     "packing": {"rows": 1, "row": [0, 0], "variable": [0, 1], "value": [1, 2]},
     "covering": {"rows": 2, "row": [0, 1, 1], "variable": [0, 0, 1], "value": [3, 1, 4]}}
"""


def test_w_stands_below_the_covering_rows_of_a_maximum_and_above_the_packing_rows_of_a_minimum(tmp_path):
    assert written(MATRICES % "max", "max-min", tmp_path, ".json") == expected("""
        max-min, exact
        max w
        packing[1]: x[a] + 2 x[b] <= 1
        covering[1]: 3 x[a] - w >= 0
        covering[2]: x[a] + 4 x[b] - w >= 0
        x[a], x[b], w >= 0
    """)
    assert written(MATRICES % "min", "max-min", tmp_path, ".json") == expected("""
        max-min, exact
        min w
        packing[1]: x[a] + 2 x[b] - w <= 0
        covering[1]: 3 x[a] >= 1
        covering[2]: x[a] + 4 x[b] >= 1
        x[a], x[b], w >= 0
    """)
