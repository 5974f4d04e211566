import pytest

from waybound.heuristics.auctions.list_schedule import is_ready
from waybound.reports.studies.auctions import list_schedule as families

FAMILIES = [families.full_bins("makespan"), families.full_bins("completion"), families.ONE_LONG, families.PAIRS]


@pytest.mark.parametrize("family", FAMILIES, ids=range(len(FAMILIES)))
def test_optima_are_attained_by_answers_that_pass_every_check(family: families.Family) -> None:
    for k in range(min(15, family.count(15))):
        case = family.case(k, 2)
        assert case.optimum is not None and is_ready(case.problem.jobs)
        verdict = case.problem.evaluate(case.optimum.answer)
        assert verdict.feasible and verdict.values == (case.optimum.value,)


def test_the_worst_lists_are_as_bad_as_graham_says() -> None:
    assert [families.ONE_LONG.case(k, 1).optimum.value for k in range(3)] == [6, 9, 12]
    assert [families.PAIRS.case(k, 1).optimum.value for k in range(3)] == [18, 27, 36]
