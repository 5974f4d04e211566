"""Random weighted coverage: each element covers items drawn at random, and as many elements may be chosen as a constraint allows.

An item that an element draws twice is covered once. Weights of the items are uniform in [0.5, 2].
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import UsageError
from ...generators import GENERATORS, Draw, Generator, Setting
from ..constraints import Cardinality, Constraint, Knapsack, PartitionMatroid
from ..selection import SelectionInstance
from ..set_functions import Coverage

SETTINGS = {
    "elements": Setting(1000, "number of elements", least=1, most=10_000_000),
    "items": Setting(2000, "number of items", least=1, most=10_000_000),
    "per-element": Setting(20, "items that each element draws", least=1, most=100_000),
    "constraint": Setting(
        "cardinality", "at most k elements; one of each of k groups; or costs uniform in [0.5, 1.5] up to k",
        choices=("cardinality", "partition", "knapsack"),
    ),
    "k": Setting(100, "limit, number of groups, or budget", least=1, most=10_000_000),
    "name": Setting(None, "name of the instance", type=str),
}  # fmt: skip


def make(draw: Draw, settings: Mapping[str, Any]) -> SelectionInstance:
    """One instance. Elements belong to groups in turn: element i to group i modulo k."""
    elements, items, per, k = (settings[key] for key in ("elements", "items", "per-element", "k"))
    if elements * per > 200_000_000:
        raise UsageError(f"elements={elements} with per-element={per} are too many items; at most 200000000 are drawn", "too-large")
    drawn = draw.integers(0, items - 1, (elements, per))
    drawn.sort(axis=1)
    new = np.ones(drawn.shape, dtype=bool)
    new[:, 1:] = drawn[:, 1:] != drawn[:, :-1]
    indptr = np.concatenate([[0], np.cumsum(new.sum(axis=1))])
    function = Coverage(indptr.astype(np.int32), drawn[new].astype(np.int32), draw.uniform(0.5, 2.0, items))
    rule: Constraint
    if settings["constraint"] == "cardinality":
        rule = Cardinality(k)
    elif settings["constraint"] == "partition":
        rule = PartitionMatroid.of(np.arange(elements) % k)
    else:
        rule = Knapsack(draw.uniform(0.5, 1.5, elements), float(k))
    name = settings["name"] or f"coverage-n{elements}-m{items}-{settings['constraint']}{k}-s{settings['seed']}"
    return SelectionInstance(function, rule, name=name, format="generated")


GENERATORS.enter(Generator("coverage", "random weighted coverage under a constraint on what is chosen", SETTINGS, make))
