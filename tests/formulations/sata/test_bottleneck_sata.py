import itertools
import json
from dataclasses import replace

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st
from sata_cases import CASES, dense_weights, random_graph, relabelled, selections, value

import waybound as wb
from waybound.formulations.sata.selections import Selection
from waybound.instances.sata.sensing_graph import graph_of_edges

FIGURE = CASES["S1"].graph
seeds = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize("name", CASES)
def test_the_best_selection_of_a_reference_case_has_its_value(name):
    case = CASES[name]
    problem = wb.BottleneckSATA(case.graph)
    assert max(value(problem, s) for s in selections(problem.graph)) == pytest.approx(case.bottleneck, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "shares", "worst"),
    [
        ("S1", [2 / 3, 1 / 3, 1, 0, 1 / 3, 2 / 3], 4 / 3),
        ("S6", [0.6, 0.4, 0.4, 0.6, 0.4, 0.6], 6 / 5),
        ("S7", [5 / 7, 2 / 7, 2 / 7, 5 / 7], 12 / 7),
        ("S9", [1 / 3] * 3, 1 / 3),
    ],
)
def test_shares_that_are_known_to_be_best_have_their_value(name, shares, worst):
    assert value(wb.BottleneckSATA(CASES[name].graph, fractional=True), shares) == pytest.approx(worst, abs=1e-12)


@given(seeds)
def test_the_value_is_the_least_column_of_the_chosen_rows(seed):
    graph = random_graph(np.random.default_rng(seed))
    dense = dense_weights(graph)
    for chosen in selections(graph):
        assert value(wb.BottleneckSATA(graph), chosen) == pytest.approx(dense[list(chosen)].sum(axis=0).min(initial=np.inf), abs=1e-12)


@given(seeds)
def test_whole_shares_are_worth_what_the_selection_is(seed):
    graph = random_graph(np.random.default_rng(seed))
    for chosen in selections(graph):
        shares = np.zeros(graph.num_actions)
        shares[list(chosen)] = 1
        assert value(wb.BottleneckSATA(graph, fractional=True), shares) == value(wb.BottleneckSATA(graph), chosen)


@given(seeds)
def test_relabelling_changes_no_value(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng)
    other, new = relabelled(graph, rng)
    for chosen in selections(graph):
        moved = Selection.of(new[list(chosen)] if len(chosen) else ())
        assert value(wb.BottleneckSATA(other), moved) == pytest.approx(value(wb.BottleneckSATA(graph), chosen), abs=1e-12)


@given(seeds, st.floats(1e-3, 1e3))
def test_scaled_weights_scale_the_value(seed, factor):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng)
    scaled = replace(graph, weights=graph.weights * factor)
    shares = rng.random(graph.num_actions) / graph.num_actions
    for fractional, answer in ((True, shares), (False, next(itertools.islice(selections(graph), 1, None), Selection()))):
        before, after = (wb.BottleneckSATA(g, fractional=fractional) for g in (graph, scaled))
        assert value(after, answer) == pytest.approx(factor * value(before, answer), rel=1e-12)


def test_an_idle_robot_changes_nothing_and_an_unseen_target_everything():
    idle, unseen = replace(FIGURE, num_robots=4), replace(FIGURE, num_targets=4)
    best = Selection.of([0, 2, 5])
    assert value(wb.BottleneckSATA(idle), best) == value(wb.BottleneckSATA(FIGURE), best) == 1.0
    assert value(wb.BottleneckSATA(unseen), best) == 0.0
    assert wb.BottleneckSATA(unseen).notes == ("1 target that no action sees: 4",)


def test_quantities_count_the_covered_targets():
    assert wb.BottleneckSATA(FIGURE).evaluate(Selection.of([0, 2])).quantities == {"covered_targets": 3.0}
    assert wb.BottleneckSATA(FIGURE).evaluate(Selection()).quantities == {"covered_targets": 0.0}


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ([0, 1], [("one-action", "robot 1 takes 2 actions", 1.0)]),
        ([2, 2], [("actions", "action 2.1 is chosen twice", 1.0)]),
        ([0, 6, -1, 10**30], [("actions", f"action number {k} does not exist", 1.0) for k in (6, -1, 10**30)]),
    ],
)
def test_a_faulty_selection_is_told_by_name(elements, says):
    judged = wb.BottleneckSATA(FIGURE).evaluate(Selection.of(elements))
    assert [(v.check, v.message, v.amount) for v in judged.violations] == says
    assert [c.passed for c in judged.checks] == [not any(c.name == check for check, _, _ in says) for c in judged.checks]
    assert judged.checks[0].tested == len(elements)


@pytest.mark.parametrize(
    ("shares", "says"),
    [
        ([0.5, 0.6, 0, 0, 0, 0], "the shares of robot 1 sum to 1.1, more than 1"),
        ([0, 0, -0.25, 0, 0, 0], "the share of action 2.1 is -0.25, not 0 or more"),
        ([0, 0, 0, 0, np.nan, 0], "the share of action 3.1 is nan, not 0 or more"),
        ([np.inf, 0, 0, 0, 0, 0], "the share of action 1.1 is inf, not 0 or more"),
    ],
)
def test_faulty_shares_are_told_by_name(shares, says):
    judged = wb.BottleneckSATA(FIGURE, fractional=True).evaluate(shares)
    assert says in [v.message for v in judged.violations]


def test_residuals_within_the_tolerance_pass():
    judged = wb.BottleneckSATA(FIGURE, fractional=True).evaluate([0.5, 0.5 + 9e-7, -9e-7, 0, 0, 0])
    assert judged.feasible
    assert [c.residual for c in judged.checks] == pytest.approx([9e-7, 9e-7])


@pytest.mark.parametrize(
    ("fractional", "answer"), [(False, [0, 2]), (False, None), (True, [0.5]), (True, Selection()), (True, "all"), (True, None)]
)
def test_another_sort_of_answer_is_a_usage_error(fractional, answer):
    with pytest.raises(wb.UsageError, match="an answer to bottleneck"):
        wb.BottleneckSATA(FIGURE, fractional=fractional).evaluate(answer)


def test_without_a_target_there_is_no_worst_one():
    with pytest.raises(wb.InputError, check=coded("missing")):
        wb.BottleneckSATA(graph_of_edges([0], [], [], robots=1))


def test_the_two_problems_tell_each_other_apart():
    whole, shares = wb.BottleneckSATA(FIGURE), wb.BottleneckSATA(FIGURE, fractional=True)
    assert (whole.problem, shares.problem, whole.senses) == ("bottleneck", "bottleneck-lp", ("max",))
    assert whole.digest() != shares.digest()
    assert whole.features() - shares.features() == {"whole-actions"}
    assert repr(shares) == "<BottleneckSATA (fractional) sensing-graph: 3 robots, 3 targets>"


@given(seeds)
def test_answers_survive_json(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng)
    whole, shares = wb.BottleneckSATA(graph), wb.BottleneckSATA(graph, fractional=True)
    for chosen in itertools.islice(selections(graph), 5):
        assert whole.answer_from_json(json.loads(json.dumps(whole.answer_to_json(chosen)))) == chosen
    x = rng.random(graph.num_actions) * (rng.random(graph.num_actions) < 0.5)
    assert np.array_equal(shares.answer_from_json(json.loads(json.dumps(shares.answer_to_json(x)))), x)


@pytest.mark.parametrize(
    ("fractional", "data", "says"),
    [
        (False, [], "not an assignment of actions"),
        (False, {"kind": "selection", "elements": []}, "not an assignment of actions"),
        (False, {"kind": "assignment", "actions": [{"action": "p9"}]}, "entry 1 of the actions names no known action"),
        (False, {"kind": "assignment", "actions": ["p1"]}, "entry 1 of the actions names no known action"),
        (False, {"kind": "assignment", "actions": [{"action": "p1", "robot": "r2"}]}, "action p1 belongs to robot r1; found r2"),
        (True, {"kind": "assignment", "actions": []}, "not a division of robots among actions"),
        (True, {"kind": "shares", "actions": [{"action": "p9", "share": 1}]}, "entry 1 of the actions names no known action"),
        (True, {"kind": "shares", "actions": [{"action": "p1", "share": "half"}]}, "the share of action p1 is not a number"),
        (True, {"kind": "shares", "actions": [{"action": "p1", "share": True}]}, "the share of action p1 is not a number"),
        (True, {"kind": "shares", "actions": [{"action": "p1"}]}, "the share of action p1 is not a number"),
    ],
)
def test_a_file_that_is_no_answer_is_refused(fractional, data, says):
    problem = wb.read("figure-3-3", fractional=fractional)
    with pytest.raises(wb.InputError, match=says):
        problem.answer_from_json(data)


def test_the_frame_has_a_row_for_each_action_in_use():
    frame = wb.read("figure-3-3").answer_to_frame(Selection.of([5, 2]))
    assert frame.to_dict("list") == {"robot": ["r2", "r3"], "action": ["p3", "p6"], "share": [1.0, 1.0], "targets": [2, 1]}
    frame = wb.read("figure-3-3", problem="bottleneck-lp").answer_to_frame([0.25, 0, 0, 0, 0, 0.5])
    assert frame["share"].tolist() == [0.25, 0.5]


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        ({}, "bottleneck"), ({"fractional": "true"}, "bottleneck-lp"), ({"fractional": True}, "bottleneck-lp"),
        ({"fractional": False}, "bottleneck"), ({"problem": "bottleneck-lp"}, "bottleneck-lp"), ({"convention": "exact"}, "bottleneck"),
    ],
)  # fmt: skip
def test_settings_choose_between_whole_actions_and_shares(settings, problem):
    assert wb.read("figure-3-3", **settings).problem == problem


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"vehicles": 3}, "bottleneck has no setting 'vehicles'; it takes fractional"),
        ({"convention": "trunc1"}, "bottleneck problems have no distances to round: the convention can only be exact, not 'trunc1'"),
        ({"problem": "vrptw"}, "holds no routing data"),
        ({"problem": "max-min-lp"}, "holds no packing and covering rows"),
    ],
)
def test_settings_that_make_no_sense_are_refused(settings, says):
    with pytest.raises(wb.UsageError, match=says):
        wb.read("figure-3-3", **settings)


@pytest.mark.parametrize(
    ("settings", "code"), [({"fractional": "half"}, "malformed"), ({"problem": "bottleneck-lp", "fractional": False}, "contradiction")]
)
def test_fractional_is_true_or_false_and_that_of_the_problem(settings, code):
    with pytest.raises(wb.UsageError, check=coded(code)):
        wb.read("figure-3-3", **settings)


def test_other_instances_hold_no_sensing_graph():
    with pytest.raises(wb.UsageError, match="demo-tiny holds no sensing graph, so it cannot be read as bottleneck"):
        wb.read("demo-tiny", problem="bottleneck")
