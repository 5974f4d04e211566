"""Selection problems: values by hand and by enumeration, constraints, answers as files and tables."""

import itertools
import json

import numpy as np
import pytest
from coded import check_coded, coded
from draws import draws
from file_cases import check_refused
from hypothesis import given, settings, strategies as st

import waybound as wb
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.sata.selections import Selection

seeds = st.integers(0, 2**32 - 1)
COVER = wb.Coverage.from_sets([[0, 2], [1], [0, 1], []], [1.0, 2.5, 4.0])


def random_functions(rng, elements=5, items=4):
    """One function as coverage or weights, and its values by definition: f(S) = sum over items of the largest entry of S."""
    matrix = rng.random((elements, items)).round(3) * (rng.random((elements, items)) < 0.6)
    weights = rng.random(items).round(3)
    sets = [np.nonzero(row)[0] for row in matrix]
    indptr = np.cumsum([0, *map(len, sets)])
    entries = np.concatenate(sets)
    owner = np.repeat(np.arange(elements), np.diff(indptr))
    return [
        (wb.Coverage.from_sets(sets, weights), (matrix > 0) * weights),
        (wb.FacilityLocation(indptr, entries, matrix[owner, entries], items), matrix),
        (wb.DenseFacilityLocation(matrix), matrix),
        (wb.DenseFacilityLocation(matrix.astype(np.float32)), matrix.astype(np.float32)),
        (wb.UserFunction(lambda masks: (masks[:, :, None] * matrix).max(axis=1).sum(axis=1), elements), matrix),
    ]


def subsets(count):
    return itertools.chain.from_iterable(itertools.combinations(range(count), k) for k in range(count + 1))


@settings(max_examples=draws(30))
@given(seeds)
def test_every_function_has_the_value_of_its_definition(seed):
    for function, matrix in random_functions(np.random.default_rng(seed)):
        problem = wb.SubmodularSelection(function, wb.Cardinality(5))
        for chosen in subsets(5):
            expected = float(matrix[list(chosen)].max(axis=0, initial=0.0).astype(np.float64).sum())
            assert problem.value(list(chosen)) == pytest.approx(expected, abs=1e-12)
            assert problem.evaluate(Selection(chosen)).values[0] == pytest.approx(expected, abs=1e-12)


@settings(max_examples=draws(30))
@given(seeds)
def test_gains_are_differences_of_values(seed):
    rng = np.random.default_rng(seed)
    order = rng.permutation(5).tolist()
    for function, _ in random_functions(rng):
        problem = wb.SubmodularSelection(function, wb.Cardinality(5))
        values = [problem.value(order[:k]) for k in range(6)]
        assert problem.gains(order) == pytest.approx(np.diff(values), abs=1e-12)
        frame = problem.answer_to_frame(Selection.of(order))
        assert frame["value"].tolist() == pytest.approx(values[1:], abs=1e-12)
        assert frame["element"].tolist() == [str(e + 1) for e in order]


@settings(max_examples=draws(30))
@given(seeds)
def test_relabelling_changes_no_value_and_scaled_weights_scale_it(seed):
    rng = np.random.default_rng(seed)
    function, matrix = random_functions(rng)[1]
    new = rng.permutation(5)
    moved = np.empty_like(matrix)
    moved[new] = matrix
    other, scaled = wb.DenseFacilityLocation(moved), wb.DenseFacilityLocation(2.5 * matrix)
    problems = [wb.SubmodularSelection(f, wb.Cardinality(5)) for f in (function, other, scaled)]
    for chosen in subsets(5):
        before = problems[0].value(list(chosen))
        assert problems[1].value(new[list(chosen)]) == pytest.approx(before, abs=1e-12)
        assert problems[2].value(list(chosen)) == pytest.approx(2.5 * before, abs=1e-12)


@settings(max_examples=draws(30))
@given(seeds)
def test_exactly_the_sets_that_a_constraint_allows_are_feasible(seed):
    rng = np.random.default_rng(seed)
    function = random_functions(rng)[0][0]
    groups, limits, costs = rng.integers(0, 3, 5), rng.integers(0, 3, 3), rng.random(5).round(2)
    budget = float(rng.random() * 2)
    for chosen in subsets(5):
        members = list(chosen)
        for rule, allowed in (
            (wb.Cardinality(2), len(members) <= 2),
            (wb.PartitionMatroid.of(groups, limits), all((groups[members] == g).sum() <= limits[g] for g in range(3))),
            (wb.Knapsack(costs, budget), costs[members].sum() <= budget + 1e-6),
        ):
            assert wb.SubmodularSelection(function, rule).evaluate(Selection(chosen)).feasible is bool(allowed)


@pytest.mark.parametrize(
    ("rule", "elements", "says"),
    [
        (wb.Cardinality(1), [0, 2], ("cardinality", "2 elements are chosen, at most 1 are allowed", 1.0)),
        (wb.Cardinality(3), [0, 0], ("elements", "element a is chosen twice", 1.0)),
        (wb.Cardinality(3), [-1], ("elements", "element number -1 does not exist", 1.0)),
        (wb.Knapsack([1, 2, 3, 4], 2.5), [0, 1], ("knapsack", "the chosen elements cost 3, the budget is 2.5", 0.5)),
        (wb.PartitionMatroid.of([0, 0, 1, 1]), [2, 3], ("partition", "2 elements of group 2 are chosen, 1 allowed", 1.0)),
        (wb.PartitionMatroid.of([0, 0, 1, 1], [0, 1]), [1], ("partition", "1 elements of group 1 are chosen, 0 allowed", 1.0)),
    ],
)
def test_faults_are_told_by_name(rule, elements, says):
    judged = wb.SubmodularSelection(COVER, rule, element_names=tuple("abcd")).evaluate(Selection.of(elements))
    (violation,) = judged.violations
    assert (violation.check, violation.message, violation.amount) == says


def test_the_empty_set_is_an_answer_and_is_worth_nothing():
    for rule in (wb.Cardinality(1), wb.PartitionMatroid.of([0] * 4), wb.Knapsack([1] * 4, 0)):
        judged = wb.SubmodularSelection(COVER, rule).evaluate(Selection())
        assert judged.feasible and judged.values == (0.0,)


def test_another_sort_of_answer_is_a_usage_error():
    with pytest.raises(wb.UsageError, match="an answer to a selection problem is a Selection, not tuple"):
        wb.SubmodularSelection(COVER, wb.Cardinality(1)).evaluate((0,))
    with pytest.raises(wb.UsageError, check=coded("malformed")):
        Selection.of(["a"])


def test_answers_survive_json_and_foreign_ones_are_refused():
    problem = wb.SubmodularSelection(COVER, wb.Cardinality(4), element_names=tuple("abcd"))
    for chosen in subsets(4):
        assert problem.answer_from_json(json.loads(json.dumps(problem.answer_to_json(Selection(chosen))))) == Selection(chosen)
    for data in ([], {"kind": "assignment"}, {"kind": "selection"}, {"kind": "selection", "elements": "a"}):
        with pytest.raises(wb.InputError, check=coded("malformed")):
            problem.answer_from_json(data)
    with pytest.raises(wb.InputError, match="the answer chooses an unknown element 'e'"):
        problem.answer_from_json({"kind": "selection", "elements": ["a", "e"]})


# -- the user's own function ----------------------------------------------------------------------------------------------


def test_a_function_of_ones_own_is_asked_for_many_sets_at_once():
    asked = []

    def root(masks):
        asked.append(masks.shape)
        return np.sqrt(masks.sum(axis=1))

    problem = wb.SubmodularSelection(wb.UserFunction(root, 4, monotone=True, submodular=True, label="root"), wb.Cardinality(2))
    assert problem.evaluate(Selection.of([0, 3])).values[0] == pytest.approx(2**0.5)
    assert all(shape[1] == 4 for shape in asked)
    assert problem.features() == {"function:user", "constraint:cardinality"}


@pytest.mark.parametrize(
    ("function", "code"),
    [
        (lambda masks: np.ones(len(masks)), "unsupported"),
        (lambda masks: 0.0, "wrong-shape"),
        (lambda masks: np.full(len(masks), np.nan), "out-of-range"),
    ],
)
def test_a_function_that_does_not_keep_the_contract_is_refused(function, code):
    with pytest.raises(wb.InputError, check=coded(code)):
        wb.SubmodularSelection(wb.UserFunction(function, 3, label="f"), wb.Cardinality(1))


# -- out of instances ------------------------------------------------------------------------------------------------------


def test_cover_30_has_the_published_greedy_values():
    problem = wb.read("cover-30")
    assert problem.gains([9, 8, 15, 2, 3, 26]).tolist() == [31, 27, 26, 21, 16, 12]
    assert problem.evaluate(Selection.of([9, 8, 15, 2, 3, 26])).values == (133.0,)
    assert problem.element_name(9) == "9"


@pytest.mark.parametrize(
    ("given_settings", "features", "best"),
    [
        ({}, {"function:facility-location", "constraint:partition"}, 11.0),
        ({"function": "coverage"}, {"function:coverage", "constraint:partition"}, 3.0),
        ({"k": 2}, {"function:facility-location", "constraint:cardinality"}, 11.0),
        ({"k": "1", "constraint": "cardinality", "function": "coverage"}, {"function:coverage", "constraint:cardinality"}, 2.0),
    ],
)
def test_actions_of_a_sensing_graph_are_elements(given_settings, features, best):
    robots = [[(5, 0, 0), (0, 3, 0)], [(0, 3, 3), (0, 0, 4)], [(0, 0, 2), (4, 0, 0)]]  # case S1w
    rows = np.array([row for robot in robots for row in robot], dtype=float)
    action, target = np.nonzero(rows)
    graph = wb.SensingGraph.from_edges([0, 0, 1, 1, 2, 2], action, target, rows[action, target])
    problem = problem_from_instance(graph, "selection", **given_settings)
    assert problem.features() == features
    found = [problem.evaluate(Selection(chosen)) for chosen in subsets(6)]
    assert max(judged.values[0] for judged in found if judged.feasible) == best
    assert problem.element_name(3) == "2.2"


@pytest.mark.parametrize(
    ("given_settings", "says"),
    [
        ({"function": "sum"}, "function must be facility-location or coverage, not 'sum'"),
        ({"k": 0}, "k must be a whole number of at least 1, not 0"),
        ({"k": "many"}, "k must be a whole number of at least 1, not 'many'"),
        ({"size": 3}, "selection has no setting 'size'; it takes function, constraint, k"),
        ({"convention": "trunc1"}, "the convention can only be exact"),
    ],
)
def test_settings_that_make_no_sense_are_refused(given_settings, says):
    with pytest.raises(wb.UsageError, match=says):
        wb.read("figure-3-3", problem="selection", **given_settings)


@pytest.mark.parametrize(
    ("given_settings", "code"),
    [
        ({"constraint": "knapsack"}, "unknown-name"),
        ({"constraint": "cardinality"}, "contradiction"),
        ({"constraint": "partition", "k": 3}, "contradiction"),
    ],
)
def test_a_number_of_elements_belongs_to_one_constraint(given_settings, code):
    with pytest.raises(wb.UsageError, check=coded(code)):
        wb.read("figure-3-3", problem="selection", **given_settings)


def test_a_file_of_a_selection_has_no_settings():
    check_refused(wb.UsageError, "selection has no setting 'k'", wb.read, "cover-30", k=3)
    check_coded(wb.UsageError, "foreign", wb.read, "demo-tiny", problem="selection")
