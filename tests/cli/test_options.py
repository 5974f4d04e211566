"""KEY=VALUE pairs, and numbers within bounds."""

import math

import pytest
from coded import coded
from hypothesis import given, strategies as st

from waybound.cli.options import MOST_WHOLE, bounded, parse_pairs, parse_value
from waybound.instances.errors import UsageError


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("3", 3), ("-3", -3), ("2.5", 2.5), ("1e3", 1000.0), (".5", 0.5), ("true", True), ("False", False), ("unlimited", "unlimited"),
        ("1-100", "1-100"), ("nan", "nan"), ("inf", "inf"), ("0x10", "0x10"), ("1_000", "1_000"),
        ("1e999", "1e999"), ("9" * 5000, "9" * 5000),
        ("\u0663", "\u0663"),
    ],
)  # fmt: skip
def test_values_are_numbers_flags_or_text(text, value):
    assert parse_value(text) == value
    assert type(parse_value(text)) is type(value)


@given(st.integers())
def test_whole_numbers_stay_whole(number):
    assert parse_value(str(number)) == number


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_decimal_numbers_are_read_back_exactly(number):
    assert parse_value(repr(number)) == number


def test_a_value_may_hold_an_equals_sign():
    assert parse_pairs(["rule=a=b"], "--set") == {"rule": "a=b"}


@pytest.mark.parametrize("pair", ["vehicles", "=3", "vehicles=", "", " = "])
def test_what_is_no_pair_is_refused(pair):
    with pytest.raises(UsageError, check=coded("malformed")):
        parse_pairs([pair], "--set")


def test_a_repeated_key_is_refused_even_with_the_same_value():
    with pytest.raises(UsageError, match="vehicles", check=coded("duplicate")):
        parse_pairs(["vehicles=3", "vehicles=3"], "--set")


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_options_must_be_finite(value):
    with pytest.raises(UsageError, check=coded("out-of-range")):
        bounded(gap=value)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("time_limit", 1e18, "--time-limit must be at most 1e+09, not 1e+18"),
        ("time_limit", 0.0, "--time-limit must be positive, not 0.0"),
        ("bound_time", 2e9, "--bound-time must be at most"),
        ("bound_time", -1.0, "--bound-time must be not negative"),
        ("memory_limit", 1e18, "--memory-limit must be at most"),
        ("iterations", 10**20, "--iterations must be a whole number between 1 and 2147483647"),
        ("iterations", 0, "--iterations must be a whole number"),
        ("seed", 2**63, "--seed must be a whole number between 0 and 9223372036854775807, not 9223372036854775808"),
        ("seed", -1, "--seed must be a whole number"),
        ("threads", 10**6, "--threads must be a whole number between 1 and 1024"),
        ("jobs", 10**400, "--jobs must be a whole number between 1 and 1024, not a number of 1329 bits"),
        ("steps", 10**12, "--steps must be a whole number"),
    ],
)
def test_what_no_machine_can_do_is_refused(name, value, says):
    with pytest.raises(UsageError) as caught:
        bounded(**{name: value})
    assert says in str(caught.value)


def test_numbers_of_every_day_pass():
    bounded(
        time_limit=0.001, bound_time=0.0, gap=0.0, memory_limit=None, iterations=None, seed=0, threads=1, steps=1, jobs=1, instances=None
    )


def test_a_value_beyond_what_machines_count_is_refused():
    assert parse_pairs([f"k={MOST_WHOLE}"], "--set") == {"k": MOST_WHOLE}
    for value in (f"{MOST_WHOLE + 1}", "-99999999999999999999", "9" * 300):
        with pytest.raises(UsageError, match=r"--set k=.*: whole numbers go up to 9223372036854775807"):
            parse_pairs([f"k={value}"], "--set")
