from typing import Any

import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound.instances.errors import UsageError
from waybound.instances.formats.waybound_json import write
from waybound.instances.generating import generate
from waybound.instances.generators import GENERATORS
from waybound.instances.routing.reach import refuse_unreachable


def test_the_recipes_are_known() -> None:
    assert set(GENERATORS) >= {"coverage", "random", "risk-allocation", "robot-tasks", "sata", "solomon", "uchoa"}


@pytest.mark.parametrize("kind", sorted(GENERATORS))
def test_the_same_seed_gives_the_same_bytes_and_another_seed_others(kind: str) -> None:
    first, again, other = (write(generate(kind, seed, name="x")) for seed in (5, 5, 6))
    assert first == again
    assert first != other


def test_text_dashes_and_underscores_are_taken() -> None:
    texts = generate("uchoa", 1, customers="20", **{"route-length": "5"})
    values = generate("uchoa", 1, customers=20, route_length=5.0)
    assert write(texts) == write(values)


@pytest.mark.parametrize(
    ("kind", "seed", "given", "message"),
    [
        ("sudoku", 1, {}, f"unknown generator 'sudoku'; choose from {', '.join(sorted(GENERATORS)[:5])}, "),
        ("random", -1, {}, "the seed must be a whole number between 0 and 9223372036854775807, not -1"),
        ("random", True, {}, "the seed"),
        ("random", "x", {}, "the seed"),
        ("random", 1, {"robots": 3}, "random has no setting 'robots'; it takes customers"),
        ("random", 1, {"customers": 0}, "customers must lie between 1 and 1e+06, not 0"),
        ("random", 1, {"customers": "many"}, "customers must be a whole number, not 'many'"),
        ("random", 1, {"customers": 2.5}, "customers must be a whole number"),
        ("random", 1, {"customers": None}, "customers must have a value"),
        ("random", 1, {"windows": "perhaps"}, "windows must be true or false"),
        ("random", 1, {"name": "a\nb"}, "name must be printable"),
        ("solomon", 1, {"class": "Z9"}, "class must be one of C1, C2, R1, R2, RC1, RC2"),
        ("solomon", 1, {"density": float("nan")}, "density must lie between 0 and 1"),
        ("solomon", 1, {"density": 1.5}, "density must lie between 0 and 1"),
        ("uchoa", 1, {"route-length": 0}, "route-length must lie between 1 and 200000"),
        ("random", 1, {"customers": 6000, "metric": "explicit"}, "of 5000 customers at most"),
        ("random", 1, {"customers": 6000, "deviation": 0.1}, "of 5000 customers at most"),
        ("uchoa", 1, {"customers": 26, "grid": 10}, "26 customers need a grid of 11 or more, not 10"),
        ("uchoa", 1, {"customers": 15_000, "positions": "C", "seeds": 2}, "15000 customers in clusters need 3 seeds or more, not 2"),
    ],
)
def test_what_does_not_exist_or_is_out_of_range_is_refused(kind: str, seed: Any, given: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError) as caught:
        generate(kind, seed, **given)
    assert message in str(caught.value)


SETTINGS = {
    "random": st.fixed_dictionaries(
        {
            "customers": st.integers(1, 12), "capacity": st.integers(0, 30), "demand": st.integers(1, 40), "windows": st.booleans(),
            "service": st.integers(0, 50), "metric": st.sampled_from(["euclidean", "EUC_2D", "explicit"]), "extent": st.integers(1, 200),
        }
    ),
    "solomon": st.fixed_dictionaries(
        {
            "class": st.sampled_from(["C1", "C2", "R1", "R2", "RC1", "RC2"]), "customers": st.integers(1, 40), "density": st.floats(0, 1),
            "width": st.floats(0, 5000), "deviation": st.floats(0, 1),
        }
    ),
    "uchoa": st.fixed_dictionaries(
        {
            "customers": st.integers(1, 60), "depot": st.sampled_from("CER"), "positions": st.sampled_from(["R", "C", "RC"]),
            "demand": st.sampled_from(["1-1", "1-10", "5-10", "1-100", "50-100", "Q", "SL"]), "seeds": st.integers(1, 9),
        }
    ),
}  # fmt: skip


@settings(max_examples=draws(60), deadline=None)
@given(st.data(), st.sampled_from(sorted(SETTINGS)), st.integers(0, 10**9))
def test_whatever_the_settings_every_customer_can_be_served_alone(data: st.DataObject, kind: str, seed: int) -> None:
    made: Any = generate(kind, seed, **data.draw(SETTINGS[kind]))
    s, d = made.sites, made.travel
    customers = s.customers
    assert (s.demand[customers] <= made.fleet[0].capacity).all()
    arrival = d.duration(0, customers)
    assert (arrival <= s.due[customers]).all()
    begin = arrival.clip(s.ready[customers])
    assert (begin + s.service[customers] + d.duration(customers, 0) <= s.due[0]).all()
    refuse_unreachable(made)
