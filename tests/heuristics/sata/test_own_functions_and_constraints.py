from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from selection_problems import CONSTRAINTS, KINDS, OWN_CONSTRAINTS, OWN_KINDS, Apart, Budgets, Roots, optimum, random_problem, run, value

import waybound as wb
from waybound import InputError, SelectionInstance, SubmodularSelection, UsageError
from waybound.formulations.verified_bounds import verified_bound
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.sata.constraints import LimitRows
from waybound.instances.sata.set_functions import AT_ENTRY, AT_ITEM, Coverage, ItemFunction, ItemWeights
from waybound.instances.writing import write_instance
from waybound.reports.tables.facts import facts, facts_table


def csr(*numbers: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Two elements: where the second begins and ends, and all items."""
    return np.array([0, *numbers[:2]], np.int32), np.array(numbers[2:], np.int32)


@dataclass(frozen=True, eq=False)
class Given(ItemFunction):
    """Two elements, and whatever weights."""

    name: ClassVar[str] = "given"
    weights: ItemWeights
    num_elements: int = 2

    def as_item_weights(self) -> ItemWeights:
        return self.weights

    def parts(self) -> tuple[Any, ...]:
        return (self.name, *self.weights.arrays)


PAIRS = [
    (kind, rule)
    for kind in (*KINDS, *OWN_KINDS)
    for rule in (*CONSTRAINTS, *OWN_CONSTRAINTS)
    if kind in OWN_KINDS or rule in OWN_CONSTRAINTS
]
BY_RULE = {
    "cardinality": {"greedy", "lazy-greedy", "stochastic-greedy", "random", "brute-force"},
    "partition": {"greedy", "lazy-greedy", "sequential-greedy", "random", "brute-force"},
    "knapsack": {"knapsack-greedy", "random", "brute-force"},
    "own-rows": {"greedy", "lazy-greedy", "random", "brute-force"},
    "own-oracle": {"greedy", "lazy-greedy", "random", "brute-force"},
}


@settings(max_examples=draws(60), deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(PAIRS), st.booleans())
def test_every_method_that_can_do_with_less_takes_them(seed: int, pair: tuple[str, str], whole: bool) -> None:
    kind, rule = pair
    problem = random_problem(np.random.default_rng(seed), kind, rule, 7, whole=whole)
    best = optimum(problem)
    takers = {name for name in HEURISTICS if not HEURISTICS[name].missing(problem)}
    by_items = problem.function.as_item_weights() is not None
    assert takers - {"lp-rounding"} == BY_RULE[rule] | (
        {"continuous-greedy"} if by_items and rule in ("cardinality", "partition") else set()
    )
    assert ("lp-rounding" in takers) == (by_items and rule != "own-oracle") == bool(problem.forms())
    for name in takers - {"lp-rounding"}:
        outcome = run(name, problem, seed)
        found = value(problem, outcome)
        assert found <= best * (1 + 1e-9) + 1e-12
        if outcome.guarantee is not None and name != "stochastic-greedy":  # whose ratio holds in expectation
            assert found * outcome.guarantee.ratio >= best * (1 - 1e-9) - 1e-12
        for evidence in outcome.evidence:
            assert verified_bound(problem, evidence) >= best * (1 - 1e-12)
        if name == "brute-force":
            assert found == pytest.approx(best, rel=1e-12, abs=1e-12)


WRITTEN = [("own-items", rule) for rule in CONSTRAINTS] + [(kind, "own-rows") for kind in (*KINDS[:4], "own-items")]


@settings(max_examples=draws(30), deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(WRITTEN))
def test_forms_write_them_down_and_their_duals_bound_them(seed: int, pair: tuple[str, str]) -> None:
    problem = random_problem(np.random.default_rng(seed), *pair, 6)
    best = optimum(problem)
    for form in ("facility-location", "strong-linearisation", "weak-linearisation"):
        found = wb.solve(problem, "highs", form=form, bound_time=0)
        assert found.status == "optimal" and found.objective == pytest.approx(best, rel=1e-6, abs=1e-6)
    rounded = wb.solve(problem, heuristic="lp-rounding", bound_time=0)
    assert isinstance(rounded.bound, float) and rounded.bound >= best * (1 - 1e-9)
    # With the multipliers of several budgets the evidence proves what the linear program does.
    assert rounded.bound <= rounded.statistics["lp_value"] * (1 + 1e-5) + 1e-5


def test_nothing_is_promised_or_bounded_by_what_is_not_known() -> None:
    problem = random_problem(np.random.default_rng(4), "coverage", "own-oracle")
    assert run("greedy", problem).guarantee is None
    with pytest.raises(UsageError, match="incremental evaluation is for"):
        run("greedy", problem, evaluation="incremental")
    with pytest.raises(UsageError, match="the elements of base break the constraint already"):
        run("lazy-greedy", SubmodularSelection(Roots(np.ones((4, 2))), Apart()), base=[1, 2])
    assert wb.solve(problem, heuristic="greedy").certificate.bound is not None  # all gains together


@pytest.mark.parametrize(
    ("own", "says"),
    [
        (ItemWeights.dense(np.array([[1.0], [-1.0]])), "weights must be finite and not negative"),
        (ItemWeights.dense(np.ones((3, 1))), "there must be weights for each element; expected 2; found 3"),
        (
            ItemWeights.sparse(AT_ENTRY, *csr(1, 2, 1, 0), np.array([1.0, np.inf]), 2),
            "the weight of entry 2 must be finite and not negative",
        ),
        (ItemWeights.sparse(AT_ITEM, *csr(1, 2, 1, 2), np.ones(2), 2), "item of entry 2 does not exist; expected 0 to 1; found 2"),
        (ItemWeights.sparse(AT_ITEM, *csr(2, 2, 1, 1), np.ones(2), 2), "the items of each element must ascend, none twice"),
        (ItemWeights.sparse(AT_ITEM, *csr(1, 2, 0, 0), np.ones(3), 2), r"one weight an item; expected 2; found \(3,\)"),
    ],
)
def test_weights_on_which_no_bound_can_rest_are_refused(own: ItemWeights, says: str) -> None:
    with pytest.raises(InputError, match=says):
        SubmodularSelection(Given(own), wb.Cardinality(1))


@pytest.mark.parametrize(
    ("costs", "limits", "says"),
    [
        ([[1.0, -1.0]], [1.0], "the coefficient of entry 2 of budget must be finite and not negative; found -1.0"),
        ([[1.0, 1.0]], [np.inf], "the limit of row 1 of budget must be finite and not negative"),
        ([[1.0, 1.0]], [-1.0], "the limit of row 1 of budget must be finite and not negative"),
        ([[1.0, 1.0, 1.0]], [1.0], "the element of entry 3 of budget does not exist; expected 0 to 1; found 2"),
        ([[1.0, 1.0], [1.0, 1.0]], [1.0], "the row of entry 3 of budget does not exist"),
    ],
)
def test_rows_on_which_no_bound_can_rest_are_refused(costs: list[list[float]], limits: list[float], says: str) -> None:
    with pytest.raises(InputError, match=says):
        SubmodularSelection(Roots(np.ones((2, 1))), Budgets(np.array(costs), np.array(limits)))


def test_an_entry_that_stands_twice_or_has_no_coefficient_is_refused() -> None:
    twice = LimitRows("time", np.zeros(2, np.int64), np.zeros(2, np.int64), np.ones(2), np.ones(1))
    with pytest.raises(InputError, match="an element stands twice in a row of time"):
        twice.check(1)
    with pytest.raises(InputError, match="each entry of the rows time must have a row, an element and a coefficient; found 2, 2 and 1"):
        replace(twice, coefficient=np.ones(1)).check(1)


def test_answers_that_break_them_are_told_so() -> None:
    f = Coverage.from_sets([[0], [1], [2]], [1.0, 1.0, 1.0])
    (fault,) = SubmodularSelection(f, Apart()).evaluate(wb.Selection((0, 1))).violations
    assert (fault.check, fault.message) == ("apart", "the chosen elements are not allowed together: apart")
    both = Budgets(np.array([[0.1, 0.1, 0.1], [1.0, 2.0, 4.0]]), np.array([0.3, 6.0]))
    problem = SubmodularSelection(f, both)
    assert problem.evaluate(wb.Selection((0, 1))).feasible
    (fault,) = problem.evaluate(wb.Selection((0, 1, 2))).violations  # 0.1 + 0.1 + 0.1 fits into 0.3
    assert fault.message == "budget no. 2: 7 where at most 6 is allowed" and fault.amount == 1.0
    assert problem.compile("facility-location").program.row_name(1) == "budget[no. 2]"


def test_they_are_told_in_tables_and_refused_by_files(tmp_path) -> None:  # type: ignore[no-untyped-def]
    problem = SubmodularSelection(Roots(np.ones((4, 2))), Apart())
    told = dict(facts_table(facts(problem)).rows)
    assert (told["function"], told["constraint"]) == ("roots, of 4 elements", "kind apart")
    with pytest.raises(InputError, match="the function roots cannot be written to a file"):
        write_instance(SelectionInstance(problem.function, problem.constraint), tmp_path / "own.json")
