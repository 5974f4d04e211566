from typing import Any

import numpy as np
import pytest
from risk_problems import problem

from waybound.instances.errors import InputError
from waybound.instances.risk.allocation import Risk


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"risk__total": 0}, "the total risk must lie between 0 and 1, both excluded; found 0"),
        ({"risk__total": 1}, "the total risk must lie between 0 and 1, both excluded; found 1"),
        ({"risk__total": -0.1}, "between 0 and 1"),
        ({"risk__total": 0.7}, "chance constraint number 1 may have a risk above 1/2, where the quantile is not convex"),
        ({"risk__each": 0.6}, None),
        ({"risk__each": 1.5}, "the risk of a constraint must lie between 0 and 1"),
        ({"risk__kind": "shared"}, "the kind of risk is unknown; expected allocated or joint"),
        ({"risk": {}}, "risk says no limit"),
        ({"risk__budgets": [{"name": "arm", "constraints": ["1"], "risk": 2}]}, "the risk of budget arm must lie between 0 and 1"),
        ({"risk__budgets": [{"constraints": ["9"], "risk": 0.1}]}, "unknown chance constraint; found '9'"),
        ({"quantities__covariance": [[1, 2], [2, 1]]}, "not positive semidefinite; found the least eigenvalue -1"),
        ({"quantities__covariance": [1, -1]}, "negative variance"),
        ({"lower": 3, "upper": 2}, "bounds of the decisions cross at 0"),
        ({"cost__terms": [{"kind": "cube", "decisions": [[1, 1]]}]}, "the kind of a cost term is unknown"),
        ({"cost__terms": [{"kind": "norm", "weight": -1, "decisions": [[1, 1]]}]}, "else the cost is not convex"),
        ({"sense": "best"}, "the sense must be min or max"),
    ],
)
def test_bad_data_have_one_clear_error(changes: dict[str, Any], said: str | None) -> None:
    if said is None:
        problem(**changes)  # the total of 0.1 keeps every risk below 1/2
        return
    with pytest.raises(InputError) as fault:
        problem(**changes)
    assert said in str(fault.value)
    assert "\n" not in str(fault.value)


def test_a_total_above_one_half_needs_a_limit_of_each() -> None:
    assert problem(risk={"total": 0.7, "each": 0.5}).caps.tolist() == [0.5, 0.5]


def test_caps_are_the_least_of_all_budgets() -> None:
    risk = Risk("allocated", 0.1, np.array([0.5, 0.02]))
    assert risk.caps().tolist() == [0.1, 0.02]
    assert [b.name for b in risk.all_budgets()] == ["total"]


def test_the_digest_covers_data_and_not_names() -> None:
    assert problem().digest() == problem(name="other").digest()
    for changes in ({"risk__total": 0.2}, {"risk__kind": "joint"}, {"chance__limits": [5, 6]}, {"quantities__covariance": [1, 2]}):
        assert problem(**changes).digest() != problem().digest()
