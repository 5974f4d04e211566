import math

import pytest
from coded import check_coded, coded
from file_cases import check_refused
from uncertain_graphs import WORKED, graph_of

from waybound.formulations.problem import problem_from_instance
from waybound.formulations.risk.uncertain_path import UncertainPath
from waybound.instances.errors import InputError, UsageError
from waybound.solving.explaining import explain


@pytest.fixture
def problem():
    return UncertainPath(graph_of(WORKED), 0.05)


def path(problem, *names):
    return problem.answer_of(list(names))


def test_the_value_is_the_cost_that_is_exceeded_with_the_probability_of_the_risk(problem):
    e = problem.evaluate(path(problem, "S", "B", "C", "G"))
    assert e.feasible
    assert (e.quantities["mean"], e.quantities["standard_deviation"]) == (151.0, math.sqrt(12.0))
    assert e.values[0] == pytest.approx(151.0 + 1.6448536269514722 * math.sqrt(12.0))
    exceeded = 0.5 * math.erfc((e.values[0] - 151.0) / math.sqrt(24.0))
    assert exceeded == pytest.approx(0.05)


def test_at_one_half_the_value_is_the_mean():
    problem = UncertainPath(graph_of(WORKED), 0.5)
    assert problem.evaluate(path(problem, "S", "A", "G")).values == (150.0,)
    assert problem.features() == {"normal-costs"}


@pytest.mark.parametrize(
    ("names", "check", "message"),
    [
        (("B", "G"), "start", "the path's start is B, not S"),
        (("S", "B"), "goal", "the path's goal is B, not G"),
        (("S", "C", "G"), "edges", "no edge leads from S to C"),
    ],
)
def test_paths_that_break_a_rule_are_told(problem, names, check, message):
    violations = problem.evaluate(path(problem, *names)).violations
    assert [(v.check, v.message) for v in violations] == [(check, message)]


def test_a_vertex_twice_is_told():
    problem = UncertainPath(graph_of([*WORKED, ("C", "B", 1, 1)]), 0.05)
    verdict = problem.evaluate(path(problem, "S", "B", "C", "B", "G"))
    assert [v.message for v in verdict.violations] == ["the path goes through B twice"]


@pytest.mark.parametrize("answer", [(), [0, 1], (0, 99), (0, True), (0.0, 1.0), "S"])
def test_what_is_no_path_is_an_input_error(problem, answer):
    with pytest.raises(InputError, check=coded("malformed")):
        problem.evaluate(answer)


def test_answers_go_through_json_by_the_names_of_the_file(problem):
    answer = path(problem, "S", "A", "G")
    assert problem.answer_to_json(answer) == {"kind": "path", "vertices": ["S", "A", "G"]}
    assert problem.answer_from_json(problem.answer_to_json(answer)) == answer
    for data in ({"kind": "path", "vertices": []}, {"kind": "routes"}, [], {"kind": "path", "vertices": ["S", "Z"]}):
        with pytest.raises(InputError):
            problem.answer_from_json(data)


def test_the_frame_adds_up(problem):
    frame = problem.answer_to_frame(path(problem, "S", "B", "C", "G"))
    assert frame["to"].tolist() == ["B", "C", "G"]
    assert frame["mean_so_far"].tolist() == [50.0, 90.0, 151.0]
    assert frame["deviation_so_far"].iloc[-1] == math.sqrt(12.0)


@pytest.mark.parametrize("risk", [0.0, -0.1, 0.500001, 1.0, math.nan, True, "often"])
def test_risks_beyond_one_half_and_none_are_refused(risk):
    with pytest.raises(UsageError, match="risk must"):
        problem_from_instance(graph_of(WORKED), risk=risk)


def test_settings_and_instances_of_others_are_refused():
    check_refused(UsageError, "uncertain-path has no setting 'speed'; it takes risk", problem_from_instance, graph_of(WORKED), speed=1)
    check_refused(UsageError, "the convention can only be exact", problem_from_instance, graph_of(WORKED), convention="round")
    check_coded(UsageError, "foreign", problem_from_instance, type("Other", (), {"name": "x", "problem": "uncertain-path"})())


def test_the_digest_tells_risks_apart():
    assert UncertainPath(graph_of(WORKED), 0.1).digest() != UncertainPath(graph_of(WORKED), 0.2).digest()


def test_a_path_of_the_fewest_edges_is_at_hand_and_refutes_whoever_says_that_there_is_none(problem):
    answer = problem.answer_at_hand()
    assert problem.evaluate(answer).feasible and len(answer) == 3
    back = UncertainPath(graph_of([("S", "G", 0, 0), ("G", "S", 0, 0)]))
    assert back.answer_at_hand() == (0, 1)


def test_there_is_nothing_to_explain(problem):
    explanation = explain(problem, time_limit=60.0)
    assert (explanation.verdict, explanation.according_to) == ("feasible", "the data")
