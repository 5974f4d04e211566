import json
import math

import numpy as np
from hypothesis import given, strategies as st

from waybound.formulations.json_text import finite, json_text


def test_numbers_that_json_does_not_know_are_null():
    data = {"a": math.inf, "b": [math.nan, np.float64(1.5), np.arange(2)], "c": (-math.inf, 3), "d": np.int64(7), "e": True}
    assert finite(data) == {"a": None, "b": [None, 1.5, [0, 1]], "c": [None, 3], "d": 7, "e": True}


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=20,
)


@given(json_values)
def test_the_text_is_standard_json_whatever_the_numbers(data):
    def refuse(name: str) -> None:
        raise AssertionError(name)

    json.loads(json_text(data), parse_constant=refuse)


def test_json_holds_no_raw_control_character():
    given = {"a\x9b": "\x7f\x85\u202e\u2028\ud800\U000e0001\x1b é 東"}
    text = json_text(given)
    assert all(line.isprintable() for line in text.split("\n"))
    assert "é 東" in text
    assert json.loads(text) == given
