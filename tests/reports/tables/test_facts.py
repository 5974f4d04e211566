import pytest

import waybound as wb
from waybound.formulations.json_text import finite
from waybound.reports.tables.facts import COMMON, facts, facts_table, plain_text


@pytest.mark.parametrize("name", ["figure-3-3", "sata-s3", "cover-30", "demo-tiny"])
def test_facts_are_plain_values_and_stand_in_the_table(name):
    problem = wb.read(name)
    data = facts(problem)
    assert finite(data).keys() == data.keys()
    assert data["instance_hash"] == problem.digest()
    labels = [row[0] for row in facts_table(data).rows]
    assert labels[:2] == ["problem", "convention"]
    assert {"targets", "constraint", "sites"} & set(labels)
    assert "hash" in labels and "forms" in labels


def test_facts_of_its_own_never_hide_what_is_told_of_every_problem():
    for name in ("figure-3-3", "cover-30", "demo-tiny"):
        assert not set(wb.read(name).facts()) & (set(COMMON) - {"objective"})


def test_facts_that_nobody_has_words_for_are_told_as_they_are():
    common = {name: [] for name in COMMON if name != "objective"} | {
        "name": "n", "problem": "p", "family": "unheard-of", "convention": "exact", "instance_hash": "h",
    }  # fmt: skip
    rows = facts_table({**common, "busy_hours": 3.0, "crew": {"size": 2, "names": []}, "days": list(range(30))}).rows
    assert ("busy hours", "3") in rows
    assert ("crew", "size 2, names none") in rows
    assert ("days", "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, ...") in rows


@pytest.mark.parametrize(
    ("value", "text"), [(None, "none"), (True, "yes"), (False, "no"), (2.5, "2.5"), (float("inf"), "inf"), ("x", "x"), ({}, "none")]
)
def test_any_value_has_a_text(value, text):
    assert plain_text(value) == text
