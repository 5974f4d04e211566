import numpy as np
import pytest
from coded import coded
from random_sensing import random_graph

import waybound as wb
from waybound import BottleneckSATA, Cardinality, Coverage, Problem, Selection, SubmodularSelection, WinnerTakesAllSATA
from waybound.formulations.sata.decided_elements import FEATURE
from waybound.instances.errors import InputError, UnsupportedError

GRAPH = random_graph(2, robots=3, targets=4, most_actions=2)
PROBLEMS = {
    "selection": SubmodularSelection(
        Coverage(np.array([0, 2, 3, 5], np.int32), np.array([0, 1, 1, 0, 2], np.int32), np.array([3.0, 2.0, 1.0])), Cardinality(2)
    ),
    "winner-takes-all": WinnerTakesAllSATA(GRAPH),
    "bottleneck": BottleneckSATA(GRAPH),
}


def chosen(element: int, holds: bool = True) -> tuple[dict[str, int], bool]:
    return {"chosen": element}, holds


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_an_answer_that_breaks_a_decision_is_no_answer(problem: Problem) -> None:
    part = problem.restricted([chosen(0), chosen(2, False)])
    assert problem.evaluate(Selection((2,))).feasible
    judged = part.evaluate(Selection((2,)))
    assert [v.message.rsplit(" ", 1)[1] for v in judged.violations if v.check == "decided"] == ["taken", "dropped"]
    assert part.evaluate(Selection((0,))).feasible
    assert part.evaluate(Selection((0,))).values == problem.evaluate(Selection((0,))).values


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_a_restricted_problem_is_another_problem_that_whole_methods_refuse(problem: Problem) -> None:
    part = problem.restricted([chosen(0)])
    assert len({problem.digest(), part.digest(), problem.restricted([chosen(0, False)]).digest()}) == 3
    assert part.features() - problem.features() == {FEATURE}
    assert part.forms() == []
    with pytest.raises(UnsupportedError):
        wb.solve(part, "highs")
    assert problem.restricted([chosen(1)]).restricted([chosen(0)]).digest() == problem.restricted([chosen(0), chosen(1)]).digest()


@pytest.mark.parametrize(
    "statement", [None, 0, "0", {"chosen": "0"}, {"chosen": True}, {"chosen": -1}, {"chosen": 99}, {"chosen": 0, "x": 1}]
)
@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_what_is_no_statement_on_an_element_is_refused(problem: Problem, statement: object) -> None:
    with pytest.raises(InputError, check=coded("malformed")):
        problem.restricted([(statement, True)])


def test_nothing_can_be_stated_of_shares() -> None:
    with pytest.raises(InputError, check=coded("unsupported")):
        BottleneckSATA(GRAPH, fractional=True).restricted([chosen(0)])
