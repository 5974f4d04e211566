"""Kinds of waybound's JSON: each writes what it reads, and refuses keys that it does not know."""

import pytest
from file_cases import check_refused

from waybound.instances.document import dump_json, parse_json
from waybound.instances.errors import InputError
from waybound.instances.formats import FORMATS
from waybound.instances.generating import generate
from waybound.instances.kinds import KINDS
from waybound.instances.sata.max_min_lp import MaxMinInstance, SparseMatrix

EXAMPLES = {
    "routing": lambda: generate("random", customers=4, seed=1),
    "sensing": lambda: generate("sata", robots=3, targets=6, phi=40, seed=1),
    "selection": lambda: generate("coverage", elements=5, items=6, per_element=2, k=2, seed=1),
    "risk-allocation": lambda: generate("risk-allocation", steps=3, seed=1),
    "uncertain-graph": lambda: generate("prm-graph", vertices=5, seed=1),
    "risky-graph": lambda: generate("risky-grid", rows=3, columns=3, occupied=0, mud=0.3, tether=True, seed=1),
    "assignment": lambda: generate("assignment", robots=4, bins=5, costs="orchard", arcs=3, seed=1),
    "exploration-map": lambda: generate("exploration-map", rooms=5, seed=1),
    "generalised-assignment": lambda: generate("generalised-assignment", agents=2, jobs=3, seed=1),
    "joint-assignment": lambda: generate("joint-assignment", robots=3, bins=2, requests=2, seed=1),
    "orchard-jobs": lambda: generate("orchard-day", seed=1),
    "robot-tasks": lambda: generate("robot-tasks", robots=2, tasks=3, weight=5, seed=1),
    "max-min": lambda: MaxMinInstance(SparseMatrix.of([[1.0, 2.0]]), SparseMatrix.of([[3.0, 0.0], [1.0, 1.0]])),
}


def test_every_kind_has_an_example_here() -> None:
    assert set(KINDS) == set(EXAMPLES)


@pytest.mark.parametrize("kind", EXAMPLES)
def test_what_a_kind_writes_it_reads_back_and_writes_again_the_same(kind: str) -> None:
    instance = EXAMPLES[kind]()
    assert instance.kind == KINDS[kind].name == kind
    keys = parse_json(dump_json(KINDS[kind].encode(instance)))
    again = KINDS[kind].decode(keys)
    assert type(again) is type(instance) and KINDS[kind].encode(again) == KINDS[kind].encode(instance)
    assert FORMATS["json"].write is not None


@pytest.mark.parametrize("kind", EXAMPLES)
def test_a_key_that_a_kind_does_not_know_is_refused_and_one_that_it_needs_is_missed(kind: str) -> None:
    keys = KINDS[kind].encode(EXAMPLES[kind]())
    check_refused(InputError, "unknown key 'colour'", KINDS[kind].decode, {**keys, "colour": "red"})
    check_refused(InputError, "lacks the key 'name'", KINDS[kind].decode, {k: v for k, v in keys.items() if k != "name"})
