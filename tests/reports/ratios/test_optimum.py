import numpy as np
import pytest
import risky_cases

from waybound import Cardinality, CheckFailedError, Coverage, Selection, SubmodularSelection, UsageError
from waybound.reports.ratios.optimum import OPTIMA, Optimum, attained, optimum, subsets

PROBLEM = SubmodularSelection(Coverage.from_sets([[0], [0]], [1.0]), Cardinality(1))


def test_an_answer_that_fails_its_check_is_no_optimum():
    with pytest.raises(CheckFailedError, match="fails its check"):
        attained(PROBLEM, Selection((0, 1)), "hope")


def test_a_family_says_how_its_optima_are_found():
    with OPTIMA.temporary("selection", lambda problem: attained(problem, Selection((1,)), "hope")):
        assert optimum(PROBLEM) == Optimum(1.0, Selection((1,)), "hope")


def test_a_family_without_optima_is_refused():
    with pytest.raises(UsageError, match="no optimum is known for risky-path problems"):
        optimum(risky_cases.table_3_1())


def test_every_subset_is_there_once():
    assert subsets(3).shape == (8, 3)
    assert (subsets(3) @ [1, 2, 4] == np.arange(8)).all()
