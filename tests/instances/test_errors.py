import re
from pathlib import Path
from typing import get_args

import pytest

from waybound.instances import errors as e


def test_an_input_error_says_file_line_expected_and_found_on_one_line() -> None:
    error = e.InputError("demand\nis negative", file="a.vrp", line=7, expected="0 or more", found="-3")
    assert str(error) == "a.vrp:7: demand is negative; expected 0 or more; found -3"
    assert str(e.InputError("is empty", file="a")) == "a: is empty"
    assert str(e.InputError("is bad", line=3)) == "line 3: is bad"


def test_a_place_is_added_only_where_there_is_none() -> None:
    error = e.InputError("x", line=3, expected="y").at(file="a", line=9)
    assert str(error) == "a:3: x; expected y"
    assert str(error.at(file="b")) == "a:3: x; expected y"


def test_an_unsupported_feature_names_who_lacks_it_and_who_has_it() -> None:
    assert (
        str(e.UnsupportedError("pyvrp", {"b", "a"}, ["highs"]))
        == "pyvrp cannot take this problem: it does not handle a, b; can take it: highs"
    )
    assert "no installed alternative" in str(e.UnsupportedError("pyvrp", {"a"}))


def test_where_none_has_all_features_the_nearest_is_named_with_what_it_lacks() -> None:
    error = e.UnsupportedError("no form", {"a"}, nearest="three-index")
    assert str(error) == "no form can take this problem: the nearest, three-index, does not handle a"
    assert error.missing == ("a",)


@pytest.mark.parametrize(
    ("kind", "code"),
    [(e.InputError, 2), (e.UsageError, 2), (e.MissingPackageError, 2), (e.NoAnswerError, 4), (e.CheckFailedError, 5), (e.WayboundError, 1)],
)
def test_every_error_has_the_exit_code_of_the_design(kind: type[e.WayboundError], code: int) -> None:
    assert kind("x").exit_code == code
    assert issubclass(kind, e.WayboundError)


def test_codes_are_those_of_the_page_and_stay_with_an_error_that_is_given_a_place() -> None:
    page = (Path(__file__).parents[2] / "docs" / "errors.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `([a-z-]+)` \| ", page, flags=re.MULTILINE)[1:] == list(get_args(e.Code))
    assert (e.InputError("x").code, e.UsageError("x").code, e.WayboundError().code) == ("malformed", "contradiction", "internal")
    assert e.InputError("x", "duplicate", line=3).at(file="a").code == "duplicate"
