import math
from typing import Any

import numpy as np
import pytest

from waybound.instances.errors import UsageError
from waybound.instances.limits import MOST, check_number, check_whole


@pytest.mark.parametrize("name", MOST)
def test_the_largest_value_passes_and_the_next_does_not(name: str) -> None:
    check = check_whole if isinstance(MOST[name], int) else check_number
    check(name, MOST[name])
    with pytest.raises(UsageError, match=name):
        check(name, MOST[name] + 1 if isinstance(MOST[name], int) else math.nextafter(MOST[name], math.inf))


@pytest.mark.parametrize("value", [-1, math.nan, math.inf, 10**400, "60", None, True, [1.0]])
def test_what_is_no_number_of_at_least_zero_is_refused(value: Any) -> None:
    with pytest.raises(UsageError, match="--gap must be"):
        check_number("gap", value, option="--gap")


@pytest.mark.parametrize("value", [0, -1, 1.0, "1", None, True, 10**4000, math.nan])
def test_what_is_no_positive_whole_number_is_refused(value: Any) -> None:
    with pytest.raises(UsageError, match="threads must be a whole number between 1 and 1024") as caught:
        check_whole("threads", value, least=1)
    assert len(str(caught.value)) < 200


def test_numbers_of_numpy_are_numbers() -> None:
    check_number("time_limit", np.float32(2.5), above=0)
    check_whole("seed", np.int64(3))
    with pytest.raises(UsageError, match="time_limit must be positive, not 0"):
        check_number("time_limit", 0, above=0)
