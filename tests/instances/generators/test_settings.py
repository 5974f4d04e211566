import math
from typing import Any

import pytest
from file_cases import check_refused

from waybound.instances.errors import UsageError
from waybound.instances.generators.settings import Setting

COUNT = Setting(5, "number", least=1, most=9)
SHARE = Setting(0.5, "share", least=0.0, most=1.0)
FLAG = Setting(False, "flag")
SHAPE = Setting("ring", "shape", choices=("ring", "Star"))
NAME = Setting(None, "name", type=str)
LIMIT = Setting(None, "limit", type=int, least=1)


@pytest.mark.parametrize(
    ("setting", "given", "value"),
    [
        (COUNT, "7", 7), (COUNT, 9, 9), (COUNT, " 1 ", 1), (SHARE, "1e-1", 0.1), (SHARE, 1, 1.0), (FLAG, "YES", True), (FLAG, 0, False),
        (FLAG, True, True), (SHAPE, "STAR", "Star"), (NAME, "a b", "a b"), (NAME, None, None), (LIMIT, "unlimited", None),
        (LIMIT, "None", None), (LIMIT, 3, 3),
    ],
)  # fmt: skip
def test_a_valid_value_has_the_type_of_its_setting(setting: Setting, given: Any, value: Any) -> None:
    made = setting.value("s", given)
    assert made == value and type(made) is type(value)


@pytest.mark.parametrize(
    ("setting", "given", "words"),
    [
        (COUNT, "0", "s must lie between 1 and 9, not '0'"), (COUNT, 10, "between 1 and 9"),
        (COUNT, "2.0", "s must be a whole number, not '2.0'"), (COUNT, "two", "must be a whole number"),
        (COUNT, None, "s must have a value"), (COUNT, "none", "must be a whole number"), (SHARE, "nan", "between 0 and 1"),
        (Setting(1.0, "any"), "inf", "between -inf and inf"), (SHARE, "much", "s must be a number"),
        (FLAG, "perhaps", "s must be true or false"), (SHAPE, "square", "s must be one of ring, Star, not 'square'"),
        (NAME, "", "printable, of 1 to 100 characters"), (NAME, "a\nb", "printable"), (NAME, "x" * 101, "1 to 100"),
    ],
)  # fmt: skip
def test_another_value_is_refused_with_what_would_do(setting: Setting, given: Any, words: str) -> None:
    check_refused(UsageError, words, setting.value, "s", given)


def test_the_ends_of_a_range_belong_to_it() -> None:
    assert SHARE.value("s", 0) == 0.0 and SHARE.value("s", "1") == 1.0
    assert Setting(1.0, "any").value("s", -1.7e308) == -1.7e308
    assert not math.isfinite(Setting(1.0, "any").most)
