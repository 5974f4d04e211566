"""Tables of a campaign file: what is none of their keys, or of another kind, is told with its place."""

from pathlib import Path
from typing import Any

import pytest
from coded import coded

from waybound.instances.errors import Code, InputError
from waybound.reports.campaigns.keys import Keys

FILE = Path("c.toml")


def test_a_misspelt_key_is_answered_with_the_nearest_one() -> None:
    with pytest.raises(InputError, match=r"c\.toml: unknown key 'solver' of a table; did you mean 'solvers'", check=coded("unknown-name")):
        Keys({"solver": 1}, FILE, "a table", ("solvers", "seeds"))
    with pytest.raises(InputError, match="unknown key 'x'; there are solvers, seeds"):
        Keys({"x": 1}, FILE, "", ("solvers", "seeds"))


@pytest.mark.parametrize(
    ("method", "value", "code", "told"),
    [
        ("text", " ", "malformed", "expected a text"),
        ("texts", ["a", 1], "malformed", "a text or a list of texts"),
        ("truth", 1, "malformed", "true or false"),
        ("inner", [], "malformed", "expected a table"),
    ],
)
def test_a_value_of_another_kind_is_refused(method: str, value: Any, code: Code, told: str) -> None:
    with pytest.raises(InputError, match=told, check=coded(code)):
        getattr(Keys({"k": value}, FILE, "", ("k",)), method)("k")


def test_lists_are_read_as_they_are_meant() -> None:
    keys = Keys({"a": "x", "b": ["x", "y"], "c": ["x", {"name": "y", "h": 1}], "d": [3, 1]}, FILE, "", "abcde")
    assert keys.texts("a") == ["x"] and keys.texts("b") == ["x", "y"] and keys.texts("e") == [None]
    assert keys.entries("c", "name") == [{"name": "x"}, {"name": "y", "h": 1}] and keys.entries("e", "name") == []
    assert keys.numbers("d", [1]) == [3, 1] and keys.numbers("e", [1]) == [1]
    assert keys.truth("e") is False and keys.inner("e") == {} and "a" in keys and "e" not in keys


@pytest.mark.parametrize(
    ("value", "told"), [([1, 1], "names 1 twice"), ([], "whole numbers"), ([True], "whole numbers"), (1, "whole numbers")]
)
def test_seeds_are_whole_numbers_each_once(value: Any, told: str) -> None:
    with pytest.raises(InputError, match=told):
        Keys({"k": value}, FILE, "", ("k",)).numbers("k", [1])


def test_entries_that_are_neither_names_nor_tables_are_refused() -> None:
    with pytest.raises(InputError, match="a list of names or tables"):
        Keys({"k": [1]}, FILE, "", ("k",)).entries("k", "name")
