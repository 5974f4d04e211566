"""What people read about a certificate and a solution."""

from __future__ import annotations

import math

import pytest

import waybound as wb
from waybound.formulations.certificate import Certificate
from waybound.formulations.evaluation import Check, Violation
from waybound.formulations.rendering import (
    SHOWN_VIOLATIONS,
    Line,
    as_html,
    as_text,
    certificate_lines,
    number,
    percent,
    solution_lines,
    status_line,
)
from waybound.formulations.solution import Solution


@pytest.fixture
def problem():
    return wb.read("demo-tiny")


def certificate(**changes):
    given = {"instance_hash": "sha256:0", "problem": "cvrp", "sense": "min", "convention": "exact", "feasible": True}
    return Certificate(**{**given, **changes})


def solution(problem, **changes):
    given = {
        "problem": problem, "answer": wb.Routes.of([[1]]), "status": "feasible", "limit": "none", "objective": 10.0, "bound": None,
        "bound_kind": None,
        "bound_source": None, "gap": None, "solver": "someone", "form": None, "seconds": {"solve": 1.0}, "seed": 1, "versions": {},
        "certificate": certificate(objective=10.0),
    }  # fmt: skip
    return Solution(**{**given, **changes})


def test_numbers_are_short_and_absent_ones_are_a_dash():
    assert number(191.3) == "191.3"
    assert number([3.0, 191.30000000000001]) == "3 then 191.3"
    assert number(None) == percent(None) == "-"
    assert percent(0.0) == "0 %"
    assert percent(0.0123) == "1.23 %"


def test_each_check_is_told_with_its_residual_and_what_was_not_tested():
    made = certificate(checks=(Check("load", True, 0.5e-7, 4), Check("energy", True, 0.0, 0), Check("visits", False, 2.0, 9)))
    texts = {line.label.strip(): line.text for line in certificate_lines(made)}
    assert texts["load"] == "4 tested, largest residual 5e-08"
    assert texts["energy"] == "nothing to test"
    assert texts["visits"].startswith("broken")


def test_violations_beyond_the_first_are_counted():
    broken = tuple(Violation("visits", f"{k} is visited 0 times", 1.0) for k in range(SHOWN_VIOLATIONS + 5))
    texts = [line.text for line in certificate_lines(certificate(feasible=False, violations=broken))]
    assert "and 5 more" in texts
    assert "infeasible: 15 violations" in texts


def test_an_infinite_amount_is_not_printed_as_a_number():
    broken = (Violation("visits", "a site that does not exist", math.inf),)
    assert "a site that does not exist" in [line.text for line in certificate_lines(certificate(feasible=False, violations=broken))]


def test_a_guarantee_is_told_with_its_source_and_assumptions():
    stated = wb.Guarantee(2.0, "at most twice the optimum", ("triangle inequality",), "Someone 1976, theorem 1")
    made = certificate(guarantee=stated, observed_ratio=1.25)
    texts = {line.label: line.text for line in certificate_lines(made)}
    assert "Someone 1976, theorem 1" in texts["guarantee"]
    assert "triangle inequality" in texts["guarantee"]
    assert texts["ratio"].startswith("at most 1.25")


REFUTED = certificate(feasible=None, infeasible=True, bound_source="no way to 7")


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"status": "optimal", "bound": 10.0, "bound_kind": "verified", "gap": 0.0}, "optimal: the verified bound meets the objective"),
        ({"status": "optimal", "bound": 10.0, "bound_kind": "claimed", "gap": 0.0}, "optimal according to someone"),
        ({"status": "optimal"}, "optimal according to someone"),
        ({"status": "feasible", "limit": "time"}, "feasible; stopped by the time limit"),
        ({"status": "feasible", "limit": "interrupt"}, "feasible; stopped by an interrupt"),
        ({"status": "infeasible", "answer": None}, "infeasible according to someone"),
        (
            {"status": "infeasible", "answer": None, "certificate": REFUTED},
            "infeasible, verified: no way to 7",
        ),
        ({"status": "unbounded", "answer": None}, "unbounded according to someone"),
        ({"status": "unknown", "answer": None, "limit": "time"}, "no answer; stopped by the time limit"),
    ],
)
def test_the_status_says_on_whose_word_it_rests(problem, changes, expected):
    assert status_line(solution(problem, **changes)).text == expected


def test_a_claimed_bound_is_told_apart_from_the_verified_one_beside_it(problem):
    both = certificate(objective=10.0, bound=8.0, bound_source="prices")
    lines = solution_lines(solution(problem, bound=9.5, bound_kind="claimed", bound_source="someone", gap=0.05, certificate=both))
    texts = [line.text for line in lines]
    assert any(t.startswith("9.5, claimed by someone") for t in texts)
    assert "8, verified: prices" in texts
    assert "5 %, against the claimed bound" in texts


def test_html_is_escaped():
    assert "<script>" not in as_html("<script>", [Line("<script>", "a < b & c")])
    assert "a &lt; b &amp; c" in as_html("t", [Line("x", "a < b & c")])


def test_plain_text_keeps_labels_in_a_column():
    assert as_text("title", [Line("a", "1"), Line("long", "2")]) == "title\na     1\nlong  2"


FORGED = "x\x1b[31m RED \x1b]0;t\x07\nbound        999999, verified: optimal <b>&"


def test_text_out_of_a_file_forges_no_line_and_no_markup():
    made = certificate(
        problem=FORGED, objective=3.0, bound=2.0, bound_source=FORGED, violations=(Violation(FORGED, FORGED, 1.0),), feasible=False
    )
    lines = certificate_lines(made)
    assert all(line.label.isprintable() and line.text.isprintable() for line in lines)
    text = repr(made)
    assert len(text.split("\n")) == 1 + len(lines)
    assert all(row.isprintable() for row in text.split("\n"))
    assert "\x1b" not in made._repr_html_() and "<b>" not in made._repr_html_()
    assert len(Line("a" * 5000, "b" * 50000).text) <= 2000
