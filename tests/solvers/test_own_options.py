from typing import Any

import pytest
from file_cases import check_refused

from waybound.instances.errors import UsageError
from waybound.solvers.own_options import FEW, own_options

KNOWN = {"presolve": True, "rounds": 3, "tolerance": 1e-6, "method": "primal", "extra": None}


def test_values_get_the_type_of_the_default_and_any_where_there_is_none() -> None:
    given = {"presolve": "Off", "rounds": "7", "tolerance": "1e-3", "method": "dual", "extra": [1]}
    made = own_options("S", given, KNOWN)
    assert made == {"presolve": False, "rounds": 7, "tolerance": 1e-3, "method": "dual", "extra": [1]}
    assert [type(made[name]) for name in KNOWN] == [bool, int, float, str, list]
    assert own_options("S", {}, KNOWN) == {}


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("presolve", "perhaps", "S: option presolve takes a truth value, not 'perhaps'"),
        ("rounds", "2.5", "S: option rounds takes a whole number, not '2.5'"),
        ("rounds", None, "takes a whole number, not None"),
        ("tolerance", "small", "S: option tolerance takes a number, not 'small'"),
        ("tolerance", [], "takes a number"),
        ("threads", 2, "S: set --threads by its own option, not by threads"),
        ("speed", 1, "S has no option 'speed'; it takes presolve, rounds, tolerance, method, extra"),
    ],
)
def test_another_value_or_name_is_refused(name: str, value: Any, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        own_options("S", {name: value}, KNOWN, {"threads": "--threads"})


def test_of_many_options_the_closest_one_is_named() -> None:
    many = {f"mip_option_{k}": 1 for k in range(FEW)} | {"presolve": True}
    with pytest.raises(UsageError, match="S has no parameter 'presolv'; did you mean 'presolve'"):
        own_options("S", {"presolv": 1}, many, word="parameter")
    check_refused(UsageError, r"S has no option 'zzz'$", own_options, "S", {"zzz": 1}, many)
    check_refused(UsageError, "it takes none", own_options, "S", {"zzz": 1}, {})
