import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import pytest
from coded import coded

from waybound.instances.declared import CountOf, Declared, NameOf, Names
from waybound.instances.errors import Code, InputError
from waybound.instances.parts import Axis, Choice, Flags, Numbers, Whole, Wholes


@dataclass(frozen=True, eq=False, repr=False)
class Crews(Declared):
    """Crews, what each costs at each site, and where each is."""

    kind = "crews"
    problem_names = ("crewing",)
    content = "crews"
    axes = (Axis("crew"), Axis("site", least=0))
    cost: Annotated[Any, Numbers("crew", "site", absent=math.inf, what="cost")]
    speed: Annotated[Any, Numbers("crew", low=0.5, high=2.0, spread=True)]
    at: Annotated[Any, Wholes("crew", "site", "the place of crew {}")]
    away: Annotated[Any, Flags("crew")]
    first: Annotated[int, Whole(0, "site")] = 0
    shift: Annotated[str, Choice("day", "night", required=True)] = "day"
    pay: Annotated[Any, Numbers("crew", default=1.0)] = None
    crew_names: Names = None
    num_crews, crew_name = CountOf("crew"), NameOf("crew")


GOOD: dict[str, Any] = {"cost": [[1, math.inf], [2, 3]], "speed": 2, "at": [1, 0], "away": np.array([True, False])}


def test_all_of_json_follows_from_the_declaration() -> None:
    crews = Crews(**GOOD, crew_names=("a", "b"))
    data = crews.to_document()
    assert data == {
        "name": "crews", "problem": "crewing", "sites": {"count": 2}, "cost": [[1, None], [2, 3]], "first": 0, "shift": "day",
        "crews": {"count": 2, "name": ["a", "b"], "speed": [2, 2], "at": [1, 0], "away": [True, False]},
    }  # fmt: skip
    again = Crews.from_document(data)
    assert again.digest() == crews.digest() and again.pay.tolist() == [1, 1] and again.crew_name(1) == "b"
    assert Crews(**{**GOOD, "pay": [1, 2]}).to_document()["crews"]["pay"] == [1, 2]
    assert repr(again) == "<Crews crews: 2 crews, 2 sites>" and again.num_crews == 2
    assert not again.cost.flags.writeable


@pytest.mark.parametrize(
    ("change", "code", "message"),
    [
        ({"cost": [[1], [2, 3]]}, "malformed", "cost must be a matrix of numbers, all rows of one length"),
        ({"cost": [[1, -1], [2, 3]]}, "out-of-range", r"the cost of crew 1 and site 2 must be from 0 to 1e\+150, or infinite; found -1.0"),
        ({"cost": np.zeros((0, 2))}, "missing", "there are no crews; expected one at least"),
        ({"speed": 3}, "out-of-range", "speed of crew 1 must be from 0.5 to 2"),
        ({"speed": [1, 1, 1]}, "wrong-shape", "there must be one speed a crew; expected 2"),
        ({"at": [0, 2]}, "unknown-name", "the place of crew 2 does not exist; expected 0 to 1; found 2"),
        ({"away": [1, 0]}, "malformed", "away must have one truth value a crew"),
        ({"first": 2}, "unknown-name", "the first must be a site; expected 0 to 1; found '2'"),
        ({"shift": "noon"}, "unknown-name", "unknown shift 'noon'; expected day, night"),
        ({"crew_names": ("a",)}, "wrong-shape", "there must be one name for each crew"),
    ],
)
def test_what_a_field_must_not_hold_is_named(change: dict[str, Any], code: Code, message: str) -> None:
    with pytest.raises(InputError, match=message, check=coded(code)):
        Crews(**{**GOOD, **change})


@pytest.mark.parametrize(
    ("change", "code", "message"),
    [
        ({"shift": None}, "missing", "the document lacks the key 'shift'"),
        ({"crews": {"count": 2, "speed": [1, 1], "at": [0, 0]}}, "missing", "crews lacks the key 'away'"),
        ({"cost": [[1, None]]}, "wrong-shape", "cost has a wrong length; expected 2; found 1"),
        ({"shift": "noon"}, "unknown-name", "shift is unknown; expected day, night; found noon"),
        ({"problem": "tsp"}, "unknown-name", "problem is none of crews; expected crewing; found tsp"),
        ({"sites": {"count": 2, "name": ["a", "b"]}}, "unknown-name", "sites has an unknown key 'name'"),
    ],
)
def test_what_a_document_must_not_hold_is_named_by_its_path(change: dict[str, Any], code: Code, message: str) -> None:
    data = {**Crews(**GOOD).to_document(), **change}
    with pytest.raises(InputError, match=message, check=coded(code)):
        Crews.from_document({key: value for key, value in data.items() if value is not None})
