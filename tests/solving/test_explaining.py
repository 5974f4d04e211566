"""Why a problem has no answer."""

import _thread
import json
import math
import re
import time
from dataclasses import replace

import numpy as np
import pytest
import risk_problems
import risky_cases
from coded import coded

import waybound as wb
from waybound import Exactness, Program, Rows, Variables
from waybound.formulations.evidence import CHECKERS, Evidence
from waybound.formulations.forms import FORMS
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.backend import Control
from waybound.solving import explaining
from waybound.solving.explaining import deletion_filter, explain, in_words


def program(rows, *, integer=False, upper=10.0):
    """Rows by block: ``{"name": [(coefficients, lower, upper), ...]}`` over as many variables as coefficients."""
    size = len(next(iter(rows.values()))[0][0])
    blocks = []
    for name, entries in rows.items():
        table = np.array([entry[0] for entry in entries], dtype=float)
        counts, columns = (table != 0).sum(axis=1), np.nonzero(table)[1]
        blocks.append(
            Rows(
                name, keys=(np.arange(len(entries)),), indptr=np.concatenate([[0], np.cumsum(counts)]).astype(np.int32),
                indices=columns.astype(np.int32), data=table[table != 0], lower=np.array([e[1] for e in entries], dtype=float),
                upper=np.array([e[2] for e in entries], dtype=float),
            )
        )  # fmt: skip
    x = Variables("x", keys=(np.arange(size),), lower=np.zeros(size), upper=np.full(size, upper), cost=np.ones(size), integer=integer)
    return Program("hand-made", "min", (x,), tuple(blocks))


INF = np.inf
CLASH = {
    "need": [([1, 0, 0], 2, INF), ([0, 1, 0], 3, INF), ([0, 0, 1], 1, INF)],
    "share": [([1, 1, 0], -INF, 4), ([0, 1, 1], -INF, 9)],
    "idle": [([1, 1, 1], -INF, 25)],
}


def test_the_rows_named_are_exactly_those_that_contradict_each_other():
    made = explain(program(CLASH))
    assert made.verdict == "infeasible"
    assert {r.where for r in made.reasons} == {"need[0]", "need[1]", "share[0]"}
    assert made.minimal
    assert made.according_to == "the data"
    assert made.proof == ("rows need[0], need[1], share[0] and the bounds cannot be kept together",)


def test_rows_are_shown_as_formulas():
    texts = {r.where: r.message for r in explain(program(CLASH)).reasons}
    assert texts["share[0]"] == "x[0] + x[1] <= 4"
    assert texts["need[1]"] == "3 <= x[1]"


def test_long_rows_are_cut_and_coefficients_of_one_left_out():
    made = explain(program({"long": [([1, -1, 2.5, -3, 1, 1, 1, 1], 900, INF)]}))
    assert [r.message for r in made.reasons] == ["900 <= x[0] - x[1] + 2.5 x[2] - 3 x[3] + x[4] + x[5] + (2 more terms)"]


def test_a_contradiction_of_integrality_alone_is_found():
    made = explain(program({"even": [([2, -2], 1, 1)], "other": [([1, 1], 0, 20)]}, integer=True))
    assert {r.where for r in made.reasons} == {"even[0]"}


def test_a_program_with_a_point_has_nothing_to_explain():
    assert explain(program({"need": [([1, 1], 1, INF)]})).verdict == "feasible"


def random_row(rng, k):
    coefficients = np.where(rng.random(6) < 0.5, rng.integers(-3, 4, 6), 0) + np.eye(6)[k % 6]
    low = int(rng.integers(-9, 10))
    return coefficients, low, low + 3


def test_every_row_kept_is_needed_on_random_infeasible_programs():
    """Drop any one row of the result and HiGHS finds a point; drop none and it finds none."""
    rng = np.random.default_rng(8)
    explained = 0
    for _ in range(12):
        made = program({f"block{b}": [random_row(rng, k) for k in range(8)] for b in range(3)})
        test = explaining._Tester(made, 1e18, Control())
        if not test(np.ones(24, dtype=bool)):
            continue
        kept, minimal = deletion_filter(made, test, lambda: False)
        explained += 1
        assert minimal
        flags = np.isin(np.arange(24), kept)
        assert test(flags) is True
        for row in kept:
            assert test(flags & (np.arange(24) != row)) is False
    assert explained >= 5


def test_time_that_is_up_leaves_a_set_that_is_not_called_smallest():
    calls = iter(range(1000))
    kept, minimal = deletion_filter(program(CLASH), lambda keep: True if next(calls) < 1 else None, lambda: next(calls) > 3)
    assert not minimal
    assert kept


def test_sites_come_before_the_fleet_and_the_fleet_before_rows():
    assert {r.kind for r in explain(wb.read("demo-tiny", capacity=9)).reasons} == {"site"}
    assert {r.kind for r in explain(wb.read("demo-c25", vehicles=2)).reasons} == {"fleet"}


@pytest.fixture
def three_at_once(monkeypatch):
    """One vehicle, and three customers of which any two, but not all three, fit on one route; the data's arguments are left out."""
    monkeypatch.setattr(explaining, "reasons_from_data", lambda problem, stopped: iter(()))
    angles = np.deg2rad([0.0, 120.0, 240.0])
    xy = np.vstack([[0.0, 0.0], 10.0 * np.column_stack([np.cos(angles), np.sin(angles)])])
    sites = wb.Sites.of(range(4), ready=[0, 10, 10, 10], due=[np.inf, 30, 30, 30], coordinates=xy)
    return wb.RoutingProblem(sites, wb.Travel("euclidean", xy), (wb.VehicleType(1),), name="three", problem="vrptw")


def test_a_contradiction_that_no_argument_finds_is_told_by_rows_of_a_form_and_by_whom(three_at_once):
    made = explain(three_at_once, time_limit=120, form="two-index-mtz")
    assert (made.verdict, made.according_to, made.form, made.minimal) == ("infeasible", "the data", "two-index-mtz", True)
    assert made.evidence is not None and made.proof
    assert {r.kind for r in made.reasons} == {"row"}
    named = {r.where.split("[")[0] for r in made.reasons}
    assert "fleet" in named
    assert any("time" in name for name in named)
    assert made.message.startswith("highs finds no point for these")
    assert {r.evidence for r in made.reasons} == {None}


@pytest.mark.slow
def test_without_a_form_evidence_tells_all_the_same(monkeypatch, three_at_once):
    monkeypatch.setattr(wb.RoutingProblem, "forms", lambda self: [])
    made = explain(three_at_once, time_limit=120)
    assert (made.verdict, made.according_to, made.reasons, made.form) == ("infeasible", "the data", (), None)
    assert verified_bound(three_at_once, made.evidence) == math.inf and made.proof


def test_without_a_form_and_without_evidence_nothing_is_claimed(monkeypatch, three_at_once):
    monkeypatch.setattr(wb.RoutingProblem, "forms", lambda self: [])
    monkeypatch.setattr(explaining, "_decided", lambda problem, methods, seconds, notes: None)
    monkeypatch.setattr(explaining, "_proof", lambda problem, seconds, control: None)
    made = explain(three_at_once)
    assert (made.verdict, made.evidence) == ("undecided", None)
    assert "form" in made.message


ABOVE = "a risk above 0.1, the most that it may have"
CONTRADICTED = "constraints 1, 2 contradict each other, whatever the risk"
IN_BUDGETS = "no decision keeps the risks of chance constraints 1, 2 within their budgets, however they are shared out"


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"chance__limits": [5, 1]}, f"every decision gives chance constraint 2 {ABOVE}"),
        ({"chance__limits": [5, 1], "risk__kind": "joint"}, f"every decision gives chance constraint 2 {ABOVE}"),
        ({"constraints__lower": 8.5, "constraints__upper": 9}, f"{IN_BUDGETS}, where constraint 1 holds"),
        ({"chance__limits": [1.5, 1.5]}, IN_BUDGETS),
        ({"constraints": {"decisions": [[1, 1]] * 2, "lower": [4, 1], "upper": [5, 3]}}, CONTRADICTED),
    ],
)  # fmt: skip
def test_risks_that_no_allocation_keeps_are_named(changes, told):
    problem = risk_problems.problem(**changes)
    made = explain(problem)
    assert (made.verdict, made.according_to, made.proof) == ("infeasible", "the data", (told,))
    assert verified_bound(problem, made.evidence) == -math.inf


def test_risks_around_an_obstacle_are_told_side_by_side():
    made = explain(risk_problems.around_a_box(lower=-0.5, upper=0.5))
    assert (made.verdict, made.evidence.kind) == ("infeasible", "branching-tree")
    assert re.fullmatch(
        r"if alternative \d of box is the safest: every decision gives chance constraint box a risk above 0.05, .*", made.proof[0]
    )
    assert len(made.proof) == 6


def test_problems_with_inexact_forms_alone_are_told_to_have_an_answer():
    for problem in (risk_problems.problem(), risk_problems.problem(risk__kind="joint"), risk_problems.around_a_box(), risky_cases.mud()):
        assert not any(FORMS[name].exactness is Exactness.EXACT for name in problem.forms())
        made = explain(problem)
        assert (made.verdict, made.according_to) == ("feasible", "the data")


def test_a_risk_that_only_a_search_of_the_true_probability_could_decide_is_left_undecided():
    # Boole's inequality asks for more than there is, and no constraint by itself does.
    problem = risk_problems.problem(risk__kind="joint", constraints={"decisions": [[1, 1]], "lower": 7.2, "upper": 9})
    made = explain(problem, time_limit=120)
    assert (made.verdict, made.evidence) == ("undecided", None)
    assert "no method found an answer or a proof" in made.message


def test_each_reason_from_the_data_carries_evidence_that_its_checker_confirms():
    for problem in (wb.read("demo-tiny", capacity=9), wb.read("demo-c25", vehicles=2)):
        made = explain(problem)
        assert made.according_to == "the data"
        for reason in made.reasons:
            assert verified_bound(problem, reason.evidence) == math.inf
            assert reason.to_json()["evidence"]["kind"] == reason.evidence.kind


def test_two_customers_at_one_address_are_no_reason():
    xy = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.0]])
    sites = wb.Sites.of(range(3), due=[np.inf, 6, 6], coordinates=xy)
    made = explain(wb.RoutingProblem(sites, wb.Travel("euclidean", xy), (wb.VehicleType(1),)), time_limit=120)
    assert (made.verdict, made.according_to) == ("feasible", "the data")


def test_what_the_checker_does_not_confirm_is_no_reason(registered):
    assert "too-few-vehicles" in CHECKERS  # now all are registered
    registered(CHECKERS, "too-few-vehicles", lambda problem, data: -math.inf)
    made = explain(wb.read("demo-c25", vehicles=2), time_limit=120)
    assert "too-few-vehicles" not in {r.evidence.kind for r in made.reasons if r.evidence}


def test_a_method_that_refuses_the_problem_is_no_hindrance():
    """Too many sets for brute force, and an answer that any other heuristic finds."""
    assert explain(wb.generate("coverage", elements=60, items=80, k=20, seed=1), time_limit=120).verdict == "feasible"


def test_a_method_that_fails_is_told(monkeypatch, three_at_once):
    def fails(problem, request):
        raise wb.CheckFailedError("two and two are five")

    monkeypatch.setattr(explaining, "solve", fails)
    assert "failed: two and two are five" in explain(three_at_once, time_limit=120).message


def test_an_interrupt_keeps_the_reasons_found(monkeypatch):
    problem = wb.read("demo-c25", vehicles=2)
    whole = explaining.reasons_from_data

    def slow(problem, stopped):
        yield next(whole(problem, stopped))
        time.sleep(0.3)
        _thread.interrupt_main()
        while not stopped():
            time.sleep(0.01)

    monkeypatch.setattr(explaining, "reasons_from_data", slow)
    made = explain(problem, time_limit=120)
    assert (made.verdict, made.according_to, made.interrupted, made.message) == ("infeasible", "the data", True, "interrupted")
    assert len(made.reasons) == 1


def test_an_interrupt_before_anything_is_found_is_undecided(monkeypatch):
    def slow(problem, stopped):
        time.sleep(0.3)
        _thread.interrupt_main()
        while not stopped():
            time.sleep(0.01)
        yield from ()

    monkeypatch.setattr(explaining, "reasons_from_data", slow)
    made = explain(wb.read("demo-tiny"), time_limit=120)
    assert (made.verdict, made.interrupted) == ("undecided", True)


def test_a_point_that_is_easily_found_is_no_word_of_a_solver():
    """A coefficient that solvers drop as too small: x = 1e11 serves the covering row."""
    tiny = wb.MaxMinLP([[1.0]], [[1e-11]], sense="min")
    made = explain(tiny, time_limit=120)
    assert (made.verdict, made.according_to) == ("feasible", "the data")


def test_an_instance_with_an_answer_is_told_to_have_one():
    made = explain(wb.read("demo-tiny"), time_limit=120)
    assert (made.verdict, made.reasons) == ("feasible", ())


def test_no_time_is_refused():
    with pytest.raises(wb.UsageError, check=coded("out-of-range")):
        explain(wb.read("demo-tiny"), time_limit=0)


def test_a_short_tree_is_told_case_by_case():
    made = explain(program({"half": [([2, 2], 3, 3)]}, integer=True, upper=1.0))
    assert (made.verdict, made.according_to, made.evidence.kind) == ("infeasible", "the data", "branching-tree")
    assert made.proof == (
        "if x[1] <= 0: row half[0] and the bounds cannot be kept together",
        "otherwise, x[1] >= 1:",
        "  if x[0] <= 0: row half[0] and the bounds cannot be kept together",
        "  otherwise, x[0] >= 1: row half[0] and the bounds cannot be kept together",
    )
    assert json.loads(json.dumps(made.to_json()))["proof"] == list(made.proof)


@pytest.mark.parametrize(
    ("problem", "statement", "words"),
    [
        (wb.read("demo-tiny"), {"arc": ["1", "2"]}, ("some route goes from 1 straight to 2", "no route goes from 1 straight to 2")),
        (wb.read("cover-30"), {"chosen": 0}, ("is taken", "is dropped")),
        (wb.MaxMinLP([[1.0]], [[1.0]]), {"any": 1}, ("{'any': 1} holds", "{'any': 1} does not hold")),
    ],
)
def test_statements_are_told_in_the_problems_words(problem, statement, words):
    assert problem.in_words(statement, True).endswith(words[0])
    assert problem.in_words(statement, False).endswith(words[1])


def test_what_evidence_says_without_a_tree():
    problem = wb.read("demo-tiny")
    told = [list(in_words(problem, Evidence(kind, "", np.inf, {"ray": True}))) for kind in ("arc-multipliers", "all-routes", "other")]
    assert [len(lines) for lines in told] == [1, 1, 1]
    assert "moves that are left" in told[0][0] and "all routes" in told[1][0] and "kind other" in told[2][0]


def test_a_long_tree_is_not_told():
    nodes = [{"branch": {"arc": ["1", "2"]}}] * 8 + [{}] * 9
    assert list(in_words(wb.read("demo-tiny"), Evidence("branching-tree", "", np.inf, {"nodes": nodes}))) == []


@pytest.mark.slow
def test_a_form_with_cones_is_told_by_an_answer_and_none_of_its_rows_is_named(monkeypatch) -> None:
    made = wb.generate("random", customers=13, capacity=0, deviation=0.3, seed=1, **{"max-duration": 300.0})
    problem = replace(made, fleet=(replace(made.fleet[0], risk=0.05),))
    assert problem.forms()[0] == "three-index-cones"
    assert explain(problem, time_limit=120).verdict == "feasible"
    monkeypatch.setattr(explaining, "_has_answer", lambda *given: False)
    found = explain(problem, time_limit=120)
    assert found.verdict == "undecided" and found.message.startswith("no rows can be named, for highs takes none of the form's cones")
