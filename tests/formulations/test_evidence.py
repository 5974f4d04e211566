import json
import math
from types import SimpleNamespace

import pytest
from coded import coded

import waybound as wb
from waybound.formulations.evidence import CHECKERS, Evidence, Guarantee, Reason


@pytest.mark.parametrize("value", [12.5, -1e300, math.inf, -math.inf, 5e-324])
def test_evidence_comes_back_the_same_from_json_that_knows_no_infinity(value: float) -> None:
    given = Evidence("item-prices", "a linear program", value, {"prices": [0.5, 1.0]})
    assert Evidence.from_json(json.loads(json.dumps(given.to_json(), allow_nan=False))) == given


@pytest.mark.parametrize("missing", ["kind", "source", "value", "data"])
def test_evidence_without_one_of_its_keys_is_none(missing: str) -> None:
    data = Evidence("k", "s", 1.0, {}).to_json()
    del data[missing]
    with pytest.raises(KeyError):
        Evidence.from_json(data)


def test_what_is_read_does_not_share_the_data_of_its_source() -> None:
    data = {"kind": "k", "source": "s", "value": 1, "data": {"a": 1}}
    made = Evidence.from_json(data)
    made.data["a"] = 2
    assert data["data"] == {"a": 1} and made.value == 1.0


def test_a_reason_tells_its_evidence_or_none() -> None:
    proof = Evidence("infeasible-site", "reach", math.inf, {"site": "a"})
    assert Reason("site", "a", "nobody gets there", proof).to_json()["evidence"] == proof.to_json()
    assert Reason("row", "fleet", "x <= 1").to_json() == {"kind": "row", "where": "fleet", "message": "x <= 1", "evidence": None}


def test_a_guarantee_lists_its_assumptions() -> None:
    made = Guarantee(2.0, "at least half", ("monotone", "submodular"), "a theorem").to_json()
    assert made == {"ratio": 2.0, "statement": "at least half", "assumptions": ["monotone", "submodular"], "source": "a theorem"}


def test_a_reason_that_is_named_as_its_kind_is_named_once() -> None:
    assert Reason("fleet", "fleet", "too small").name == "fleet" and Reason("site", "mill", "too far").name == "site mill"


@pytest.mark.parametrize("kind", [kind for kind in CHECKERS if kind != "branching-tree"])  # which is for all families
def test_evidence_for_other_families_is_refused(kind: str) -> None:
    others = [SimpleNamespace(family="unheard-of", problem="none")]
    if ".routing." not in CHECKERS[kind].__module__:
        others.append(wb.read("demo-c25"))
    for other in others:
        with pytest.raises(wb.InputError, check=coded("foreign")):
            CHECKERS[kind](other, {})
