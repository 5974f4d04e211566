"""Parsed JSON: what the standard does not know is refused with its line, what a key must hold with its path."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st

from waybound.instances import document
from waybound.instances.document import DEEPEST, dump_json, fields, json_number, json_numbers, kind_of, parse_json
from waybound.instances.errors import Code, InputError


def refused(call: Callable[..., Any], *given: Any, **more: Any) -> str:
    with pytest.raises(InputError) as caught:
        call(*given, **more)
    return str(caught.value)


# -- parsing -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ('{"a": 1,\n "a": 2}', 1, "key 'a' stands twice"), ('{"b": 1,\n "c": NaN}', 2, "no such number"),
        ("[1,\n\n -Infinity]", 3, "no such number"), ('{"a": 1,\n', 2, "is no JSON"), ("[1,\n 2\n 3]", 3, "is no JSON"),
        ("", 1, "the end of the file"),
    ],
)  # fmt: skip
def test_what_is_no_json_is_refused_with_its_line(text: str, line: int, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        parse_json(text)
    assert caught.value.line == line


def test_depth_beyond_reason_is_refused_whatever_it_is_made_of() -> None:
    at_most, deeper = "[" * DEEPEST + "]" * DEEPEST, '{"a":[' * DEEPEST + "]}" * DEEPEST
    assert parse_json(at_most)
    for text in (f"[{at_most}]", deeper, "[" * 100_000 + "]" * 100_000):
        with pytest.raises(InputError, check=coded("too-large")):
            parse_json(text)


def test_numbers_beyond_floats_are_infinite_and_refused_where_a_number_is_asked_for() -> None:
    assert parse_json("1" + "0" * 400) == math.inf == parse_json("1e999")
    for beyond in (parse_json("1" + "0" * 309), 10**309):
        with pytest.raises(InputError, check=coded("out-of-range")):
            document.real(beyond, "a")


# -- what a key holds --------------------------------------------------------------------------------------------------


def test_unknown_and_missing_keys_are_named() -> None:
    assert fields({"a": 1}, "thing", ("a", "b"), ("a",)) == {"a": 1}
    assert "thing has an unknown key 'c'; expected a, b" in refused(fields, {"a": 1, "c": 2}, "thing", ("a", "b"))
    assert "thing lacks the key 'b'" in refused(fields, {"a": 1}, "thing", ("a", "b"), ("b",))
    assert "thing must be an object; found a list" in refused(fields, [], "thing", ("a",))


@pytest.mark.parametrize(
    ("reader", "given", "words"),
    [
        (document.string, 3, "must be a string; found 3"),
        (document.string, " ", "printable and not empty"),
        (document.string, "two\nlines", "printable and not empty"),
        (document.strings, ["a", None], r"k\[1\] must be a string; found null"),
        (document.array, {}, "must be a list; found an object"),
        (document.real, True, "must be a number; found true"),
        (document.real, "1", "must be a number; found '1'"),
        (document.real, None, "must be a number; found null"),
        (document.wholes, [0, 1.0], r"k\[1\] must be a whole number"),
        (document.wholes, [0, -1], r"k\[1\] must be a whole number"),
        (document.wholes, [True], r"k\[0\] must be a whole number"),
        (document.wholes, [10**18], r"k\[0\] must be a whole number"),
    ],
)
def test_a_value_of_another_sort_is_refused_with_its_path(reader: Callable[..., Any], given: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        reader(given, "k")


@pytest.mark.parametrize(
    ("given", "code"), [(True, "malformed"), (1.0, "malformed"), ("1", "malformed"), (-1, "out-of-range"), (10**18, "out-of-range")]
)
def test_a_whole_number_out_of_range_is_told_from_none(given: Any, code: Code) -> None:
    with pytest.raises(InputError, check=coded(code)):
        document.integer(given, "k", 0)


def test_lists_have_the_length_that_is_asked_for() -> None:
    assert document.reals([1, 2.5], "k", 2).tolist() == [1.0, 2.5]
    assert document.flags([True, False], "k", 2).tolist() == [True, False]
    assert document.square([[0, 1], [2, 3]], "k", 2).tolist() == [[0, 1], [2, 3]]
    for reader, wrong in ((document.reals, [1]), (document.flags, [True]), (document.square, [[0, 1]]), (document.wholes, [1])):
        assert "k has a wrong length; expected 2; found 1" in refused(reader, wrong, "k", 2)
    assert "k[1] has a wrong length" in refused(document.square, [[0, 1], [2]], "k", 2)


def test_null_is_infinity_only_where_the_key_says_so() -> None:
    assert document.reals([1, None], "k", 2, null=math.inf).tolist() == [1.0, math.inf]
    assert "k[1] must be a number; found null" in refused(document.reals, [1, None], "k", 2)
    assert "k[1] must be a number; found true" in refused(document.reals, [1, True], "k", 2, null=math.inf)
    assert "k[0] must be true or false; found 1" in refused(document.flags, [1], "k", 1)


def test_whole_numbers_have_a_least() -> None:
    assert document.integer(3, "k", 3) == 3
    for wrong in (2, 3.0, True, "3", 10**18):
        assert "k must be a whole number; expected 3 or more" in refused(document.integer, wrong, "k", 3)


@pytest.mark.parametrize(
    ("value", "words"),
    [("a", "'a'"), (None, "null"), (True, "true"), (1.5, "1.5"), ([], "a list"), ({}, "an object"), (10**31, "a number beyond all bounds")],
)
def test_what_a_value_is_in_words(value: Any, words: str) -> None:
    assert kind_of(value) == words


# -- writing -----------------------------------------------------------------------------------------------------------


def test_numbers_are_written_exactly_and_infinity_as_null() -> None:
    assert [json_number(v) for v in (3.0, -0.5, 0.1, math.inf, -math.inf, 1e300)] == [3, -0.5, 0.1, None, None, 1e300]
    assert json_numbers(np.array([[1.0, math.inf], [0.25, 2.0]])) == [[1, None], [0.25, 2]]


def test_a_line_for_each_key_and_each_object_of_a_list() -> None:
    data = {"a": [1, 2], "b": {"c": "ü", "d": []}, "e": [{"f": 1}, {}], "g": [[1, 2], [3]]}
    assert dump_json(data) == (
        '{\n  "a": [1, 2],\n  "b": {\n    "c": "ü",\n    "d": []\n  },\n  "e": [\n    {\n      "f": 1\n    },\n    {}\n  ],\n'
        '  "g": [\n    [1, 2],\n    [3]\n  ]\n}\n'
    )


JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**17), 10**17) | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=12,
)


@given(JSON)
def test_what_is_written_is_read_back(data: Any) -> None:
    assert parse_json(dump_json(data)) == data
