import itertools
import json
from dataclasses import replace

import numpy as np
import pytest
from coded import check_coded, coded
from file_cases import check_refused
from hypothesis import given, strategies as st
from sata_cases import CASES, dense_weights, random_graph, relabelled, selections, value

import waybound as wb
from waybound.formulations.sata.selections import Selection

seeds = st.integers(0, 2**32 - 1)
FIGURE = CASES["S1"].graph


@pytest.mark.parametrize("name", CASES)
def test_the_best_selection_of_a_reference_case_has_its_value(name):
    problem = wb.WinnerTakesAllSATA(CASES[name].graph)
    assert max(value(problem, s) for s in selections(problem.graph)) == pytest.approx(CASES[name].winner, abs=1e-12)


def test_the_published_selections_have_their_values():
    s3, s10 = (wb.WinnerTakesAllSATA(CASES[name].graph) for name in ("S3", "S10"))
    assert value(s3, Selection.of([2, 4, 6])) == 31
    assert value(s10, Selection.of([1, 2, 5])) == 14  # actions 2, 1, 2 of the robots
    assert value(s10, Selection.of([0, 3, 5])) == 9


@given(seeds)
def test_the_value_is_the_sum_of_the_largest_entries_of_the_chosen_rows(seed):
    graph = random_graph(np.random.default_rng(seed))
    problem, dense = wb.WinnerTakesAllSATA(graph), dense_weights(graph)
    for chosen in selections(graph):
        judged = problem.evaluate(chosen)
        best = dense[list(chosen)].max(axis=0, initial=0.0)
        assert judged.values[0] == pytest.approx(best.sum(), abs=1e-12)
        assert judged.quantities == {"elements": len(chosen), "targets": (best > 0).sum()}


@given(seeds)
def test_the_best_credit_is_the_best_of_all_credits(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng, robots=2, actions=3, targets=3)
    problem = wb.WinnerTakesAllSATA(graph)
    for chosen in selections(graph):
        every = [value(problem, Selection(chosen.elements, w)) for w in itertools.product(range(-1, 2), repeat=3)]
        assert max(every) == pytest.approx(value(problem, chosen), abs=1e-12)
        robots, weights = problem.winners(chosen.elements)
        assert value(problem, Selection(chosen.elements, tuple(robots.tolist()))) == pytest.approx(value(problem, chosen), abs=1e-12)
        assert problem.credited(chosen) == pytest.approx(weights)
        assert ((robots >= 0) == (weights > 0)).all()


def test_ties_of_credit_go_to_the_action_that_is_chosen_first():
    problem = wb.WinnerTakesAllSATA(FIGURE)
    assert problem.winners((0, 5))[0].tolist() == [0, -1, -1]
    assert problem.winners((5, 0))[0].tolist() == [2, -1, -1]


@given(seeds)
def test_relabelling_changes_no_value_and_scaled_weights_scale_it(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng)
    other, new = relabelled(graph, rng)
    scaled = replace(graph, weights=graph.weights * 3.5)
    for chosen in selections(graph):
        before = value(wb.WinnerTakesAllSATA(graph), chosen)
        assert value(wb.WinnerTakesAllSATA(other), Selection.of(new[list(chosen)] if len(chosen) else ())) == pytest.approx(
            before, abs=1e-12
        )
        assert value(wb.WinnerTakesAllSATA(scaled), chosen) == pytest.approx(3.5 * before, abs=1e-12)


def test_an_idle_robot_and_an_unseen_target_change_nothing():
    best = Selection.of([0, 2])
    for graph in (FIGURE, replace(FIGURE, num_robots=5), replace(FIGURE, num_targets=5)):
        assert value(wb.WinnerTakesAllSATA(graph), best) == 3.0


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (Selection.of([0, 1]), [("one-action", "2 elements of robot 1 are chosen, 1 allowed")]),
        (Selection.of([2, 2]), [("elements", "element 2.1 is chosen twice")]),
        (Selection.of([9]), [("elements", "element number 9 does not exist")]),
        (Selection.of([0], [0, 3, -2]), [
            ("credit", "target 2 credits robot number 3, which does not exist"),
            ("credit", "target 3 credits robot number -2, which does not exist"),
        ]),
    ],
)  # fmt: skip
def test_faults_are_told_by_name(answer, says):
    judged = wb.WinnerTakesAllSATA(FIGURE).evaluate(answer)
    assert [(v.check, v.message) for v in judged.violations] == says
    assert [c.name for c in judged.checks] == ["elements", "one-action", *(["credit"] if answer.winners is not None else [])]


def test_a_robot_is_credited_with_nothing_that_its_action_does_not_see():
    judged = wb.WinnerTakesAllSATA(FIGURE).evaluate(Selection.of([0], [0, 0, 1]))
    assert judged.feasible
    assert judged.values == (1.0,)


def test_credit_of_another_length_and_other_answers_are_usage_errors():
    check_coded(wb.UsageError, "wrong-shape", wb.WinnerTakesAllSATA(FIGURE).evaluate, Selection.of([0], [0]))
    check_refused(wb.UsageError, "is a Selection, not list", wb.WinnerTakesAllSATA(FIGURE).evaluate, [0])


@given(seeds)
def test_answers_survive_json_with_their_credit(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng)
    problem = wb.WinnerTakesAllSATA(graph)
    for chosen in itertools.islice(selections(graph), 6):
        for answer in (chosen, Selection(chosen.elements, tuple(rng.integers(-1, 3, graph.num_targets).tolist()))):
            again = problem.answer_from_json(json.loads(json.dumps(problem.answer_to_json(answer))))
            assert again.elements == answer.elements
            assert value(problem, again) == value(problem, answer)
            assert answer.winners is None or again.winners == answer.winners


@pytest.mark.parametrize(
    ("targets", "code", "says"),
    [
        ("t1", "malformed", "the answer's targets are not a list"),
        ([{"target": "t1"}], "unknown-name", "entry 1 of the answer's targets names no known target and robot"),
        ([{"target": "t9", "robot": "r1"}], "unknown-name", "entry 1 of the answer's targets"),
        ([{"target": "t1", "robot": "r1"}, {"target": "t1", "robot": "r2"}], "duplicate", "target t1 is credited twice"),
    ],
)
def test_a_file_that_is_no_answer_is_refused(targets, code, says):
    problem = wb.read("figure-3-3", problem="winner-takes-all")
    with pytest.raises(wb.InputError, match=says, check=coded(code)):
        problem.answer_from_json({"kind": "assignment", "actions": [{"action": "p1"}], "targets": targets})


def test_the_frame_has_a_row_for_each_target():
    frame = wb.read("figure-3-3", problem="winner-takes-all").answer_to_frame(Selection.of([2]))
    assert frame.to_dict("list") == {
        "target": ["t1", "t2", "t3"], "robot": ["", "r2", "r2"], "action": ["", "p3", "p3"], "weight": [0.0, 1.0, 1.0],
    }  # fmt: skip
    credited = wb.read("figure-3-3", problem="winner-takes-all").answer_to_frame(Selection.of([2], [-1, -1, 1]))
    assert credited["weight"].tolist() == [0.0, 0.0, 1.0]


def test_it_is_facility_location_under_a_partition_matroid():
    problem = wb.WinnerTakesAllSATA(FIGURE)
    assert problem.features() == {"function:facility-location", "constraint:partition"}
    assert (problem.problem, problem.digest()) == ("winner-takes-all", FIGURE.digest())
    check_refused(wb.UsageError, "winner-takes-all has no setting 'k'", wb.read, "figure-3-3", problem="winner-takes-all", k=3)
    check_refused(wb.UsageError, "cover-30 holds no sensing graph", wb.read, "cover-30", problem="winner-takes-all")
