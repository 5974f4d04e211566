import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import check_coded

from waybound.instances.errors import InputError, UsageError
from waybound.instances.routing.sites import Group, Shipment, Sites


def made(**given: Any) -> Sites:
    return Sites.of("oabc", **given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"reward": [0, -1, 0, 0]}, "reward of site a must be finite and not negative; found -1.0"),
        ({"reward": [0, 0, math.nan, 0]}, "reward of site b must be finite and not negative"),
        ({"penalty": [0, math.inf, 0, 0]}, "penalty of site a must be finite"),
        ({"pickup": [0, 0, 0, -2]}, "pickup of site c must be finite"),
        ({"demand": [[0, 0], [1, -1], [0, 0], [0, 0]]}, "demand of site a must be finite and not negative in each load dimension"),
        ({"demand": [[0, 0], [1, 1]]}, "demand must have one row a site and one column a load dimension"),
        ({"groups": [Group(())]}, "group 1 has no sites"),
        ({"groups": [Group((1, 2, 1))]}, "group 1 has the site a twice"),
        ({"groups": [Group((1, 2)), Group((2, 3))]}, "site b is in two groups"),
        ({"groups": [Group((0, 1))]}, "group 1 names the depot o"),
        ({"groups": [Group((1, 9))]}, "group 1 names site 9, which does not exist"),
        ({"groups": [Group((1, 2))], "required": True}, "site a is required and in group 1"),
        ({"groups": [Group((1, 2))], "penalty": 3.0}, "site a of group 1 has a penalty of its own"),
        ({"shipments": [Shipment(1, 1)]}, "shipment from a to a ends where it begins"),
        ({"shipments": [Shipment(0, 1)]}, "a shipment names the depot o"),
        ({"shipments": [Shipment(1, 2, (-1.0,))]}, "load of the shipment from a to b must be finite and not negative"),
        ({"shipments": [Shipment(1, 2, (1.0, 2.0))]}, "load of the shipment from a to b"),
        ({"shipments": [Shipment(1, 2)], "required": [False, True, False, True]}, "one end of the shipment from a to b is required"),
        (
            {"shipments": [Shipment(1, 2)], "ready": [0, 9, 0, 0], "service": 1.0, "due": [99, 20, 9, 20]},
            "delivery of the shipment from a to b comes before its pickup; expected a delivery after the pickup; found due 9",
        ),
        (
            {"shipments": [Shipment(1, 2), Shipment(2, 3), Shipment(3, 1)]},
            "each of these sites is to be visited before the others: a, b, c",
        ),
        ({"windows": {1: [(0, 5), (4, 9)]}}, "time windows of site a must be in order and apart from each other"),
        ({"windows": {1: [(0, math.nan), (4, 9)]}}, "time windows of site a must be in order"),
        ({"windows": {0: [(0, 2), (4, 9)]}}, "depot o has several time windows"),
        ({"windows": {1: []}}, "site a has no time window at all"),
    ],
)
def test_what_is_wrong_is_named(given: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as error:
        made(**given)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_members_of_groups_are_optional_unless_told_otherwise() -> None:
    assert made(groups=[Group((1, 3))]).required.tolist() == [False, False, True, False]


def test_several_windows_give_the_first_opening_and_the_last_close() -> None:
    sites = made(windows={2: [(12, 20), (3, 5)], 3: [(1, 2)]})
    assert (sites.ready[2], sites.due[2], sites.windows[2]) == (3, 20, ((3.0, 5.0), (12.0, 20.0)))
    assert (sites.ready[3], sites.due[3], sites.windows[3]) == (1, 2, ())
    with pytest.raises(InputError, match="ready and due of site b are not the ends of its windows"):
        replace(sites, due=np.full(4, 50.0))


def test_one_list_of_windows_a_site() -> None:
    check_coded(InputError, "wrong-shape", replace, made(), windows=((),))
    check_coded(InputError, "wrong-shape", replace, made(), skills=(frozenset(),))


def test_load_dimensions_are_columns() -> None:
    sites = made(demand=[[0, 0], [1, 4], [2, 5], [3, 6]], pickup=[0, 7, 8, 9])
    assert sites.dimensions == 2
    assert sites.demand.tolist() == [0, 1, 2, 3] and sites.further_demand.ravel().tolist() == [0, 4, 5, 6]
    assert sites.pickup.tolist() == [0, 7, 8, 9] and not sites.further_pickup.any()


def test_a_subset_keeps_what_holds_between_its_sites() -> None:
    sites = Sites.of(
        "oabcd", shipments=[Shipment(2, 3, (5.0,))], groups=[Group((1, 4))], windows={2: [(0, 1), (2, 3)]}, skills={3: ["cold"]}
    )
    few = sites.subset([0, 3, 2, 4])
    assert few.ids == ("o", "c", "b", "d")
    assert few.shipments == (Shipment(2, 1, (5.0,)),) and few.groups == (Group((3,)),)
    assert few.windows[2] == ((0.0, 1.0), (2.0, 3.0)) and few.skills[1] == {"cold"}
    assert sites.subset([0, 1]).shipments == ()
    with pytest.raises(UsageError, match="one end only of the shipment from b to c"):
        sites.subset([0, 2])
