"""Answers of risk allocation, and the words for why there is none."""

from types import SimpleNamespace

import numpy as np

from waybound.formulations.risk.allocations import SHOWN_NAMES, Allocation, contradiction


def test_anything_that_is_a_vector_will_do() -> None:
    allocation = Allocation.of([1, 2], [0.1])
    assert allocation.decision.tolist() == [1.0, 2.0] and allocation.risks is not None and allocation.risks.tolist() == [0.1]
    assert repr(allocation) == "<Allocation: 2 decisions, 1 risks>"
    assert repr(Allocation.of([1, 2])) == "<Allocation: 2 decisions>"


def told(rows, chance, **others) -> str:
    names = others.get("names", ("north", "south", "north"))
    distinct = list(dict.fromkeys(names))
    problem = SimpleNamespace(
        instance=SimpleNamespace(constraint_names=tuple(f"row {k}" for k in range(9))), names=distinct, caps=np.full(len(distinct), 0.05),
        constraint=np.array([distinct.index(name) for name in names]),
    )  # fmt: skip
    return contradiction(problem, {"rows": rows, "chance": chance})


def test_one_constraint_is_told_with_the_most_risk_that_it_may_have() -> None:
    assert told([0.0], [0.0, 3.0, 0.0]) == "every decision gives chance constraint south a risk above 0.05, the most that it may have"
    assert told([0.0, -2.0], [0.0, 3.0, 0.0]).endswith("the most that it may have, where constraint row 1 holds")


def test_several_are_told_together() -> None:
    assert told([1.0, 2.0], [1.0, 2.0, 0.0]) == (
        "no decision keeps the risks of chance constraints north, south within their budgets, however they are shared out, "
        "where constraints row 0, row 1 hold"
    )


def test_rows_alone_have_nothing_to_do_with_risk() -> None:
    assert told({"at": [4, 2], "values": [1.0, -1.0]}, [0.0] * 3) == "constraints row 2, row 4 contradict each other, whatever the risk"
    assert told({"at": [2], "values": [1.0]}, [0.0] * 3) == "no decision within its bounds keeps constraint row 2, whatever the risk"
    assert told([0.0], [0.0] * 3) == "no alternative is left"


def test_of_many_the_dearest_are_named() -> None:
    names = tuple(f"c{k}" for k in range(SHOWN_NAMES + 3))
    assert "c8, c7, c6, c5, c4, c3 and 3 more" in told([], [float(k + 1) for k in range(len(names))], names=names)
