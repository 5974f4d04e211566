import math
from typing import Any

import pytest

from waybound import Check, CheckFailedError, Evaluation, Evidence, InputError, Violation
from waybound.formulations.stated import MOST_EVIDENCE, compare_answer, real, stated_evidence, stated_guarantee

BROKEN = Evaluation((3.5,), (Check("load", False, math.inf, 2),), (Violation("load", "too much", math.inf, "truck 1"),), {})
ENTRY = {"kind": "spanning-tree", "source": "", "value": 1, "data": {}}


def fields(judged: Evaluation, **changes: Any) -> dict[str, Any]:
    whole = {
        "feasible": judged.feasible, "checks": [c.to_json() for c in judged.checks], "violations": [v.to_json() for v in judged.violations],
        "objective": judged.objective,
    }  # fmt: skip
    return {**whole, **changes}


def test_a_file_of_the_answer_itself_agrees() -> None:
    compare_answer(fields(BROKEN), BROKEN, infeasible=False)
    compare_answer(fields(BROKEN, violations=[{**BROKEN.violations[0].to_json(), "message": "in other words"}]), BROKEN, infeasible=False)
    compare_answer({}, BROKEN, infeasible=False)
    compare_answer({"feasible": None, "checks": [], "violations": []}, BROKEN, infeasible=False)  # a bound alone


@pytest.mark.parametrize(
    "changes",
    [
        {"feasible": True}, {"violations": []}, {"violations": [{"check": "load"}]}, {"objective": 3.6}, {"objective": [3.5, 1.0]},
        {"checks": [{"name": "load", "passed": True, "residual": None, "tested": 2}]},
        {"checks": [{"name": "load", "passed": False, "residual": 7.0, "tested": 2}]}, {"objective": 10**400},
    ],
)  # fmt: skip
def test_what_is_not_so_of_the_answer_fails(changes: dict[str, Any]) -> None:
    with pytest.raises(CheckFailedError, match="the certificate states"):
        compare_answer(fields(BROKEN, **changes), BROKEN, infeasible=False)


def test_no_answer_is_feasible_where_there_is_none() -> None:
    with pytest.raises(CheckFailedError, match="proves that there is none"):
        compare_answer({"feasible": True}, None, infeasible=True)


@pytest.mark.parametrize("value", [None, True, "1", [1], math.nan, math.inf, 10**400])
def test_what_is_no_finite_number_is_refused(value: Any) -> None:
    with pytest.raises(InputError, match="the certificate's bound is not a finite number"):
        real(value, "bound")


@pytest.mark.parametrize(
    "entries",
    [
        "x", [3], [{}], [{**ENTRY, "kind": 3}], [{**ENTRY, "source": None}], [{**ENTRY, "data": [1]}], [{**ENTRY, "value": "nan"}],
        [{**ENTRY, "value": True}], [{**ENTRY, "value": []}], [ENTRY] * (MOST_EVIDENCE + 1),
    ],
)  # fmt: skip
def test_malformed_evidence_is_refused(entries: Any) -> None:
    with pytest.raises(InputError, match="evidence"):
        stated_evidence({"evidence": entries})


def test_evidence_is_read() -> None:
    assert stated_evidence({}) == []
    assert stated_evidence({"evidence": [{**ENTRY, "value": "-inf"}]}) == [Evidence("spanning-tree", "", -math.inf, {})]


@pytest.mark.parametrize(
    "given",
    [
        "x", {}, {"ratio": 2.0}, {"ratio": 0.5, "statement": "", "source": ""}, {"statement": 1, "source": ""},
        {"ratio": 2.0, "statement": "", "source": "", "assumptions": [10**400]},
    ],
)  # fmt: skip
def test_malformed_guarantees_are_refused(given: Any) -> None:
    with pytest.raises(InputError, match="guarantee"):
        stated_guarantee({"guarantee": given})


def test_an_objective_agrees_but_for_rounding_at_any_scale() -> None:
    for scale in (1e-12, 1.0, 1e12):
        judged = Evaluation((3.5 * scale,), (), (), {})
        compare_answer(fields(judged, objective=3.5 * scale * (1 + 1e-12)), judged, infeasible=False)
        with pytest.raises(CheckFailedError, match="the certificate states the objective"):
            compare_answer(fields(judged, objective=3.5 * scale * (1 + 1e-6)), judged, infeasible=False)
