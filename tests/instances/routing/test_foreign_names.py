import inspect
from typing import Any

import pytest

from waybound.instances.routing import foreign_names
from waybound.instances.routing.foreign_names import ELSEWHERE, OURS, elsewhere, hint, may_be_another_load, ours
from waybound.instances.routing.frame_columns import COLUMNS, known
from waybound.instances.routing.frame_fleet import SHIFT
from waybound.instances.routing.frame_lists import COLUMNS as LISTS
from waybound.instances.routing.frame_travel import MOVES
from waybound.instances.routing.json_vehicles import VEHICLE_KEYS

PLAIN = {"id", "name", "description", "location", "self", "default_service"}
"""Fields that say nothing of the problem, and the place, which is told by values."""

ROUTING_GUIDES = {
    "sites": (
        "demands", "time_windows", "pickups_deliveries", "penalty", "service_time", "num_vehicles", "vehicle_capacities", "starts", "ends",
    ),
    "fleet": ("vehicle_capacities", "num_vehicles", "starts", "ends", "vehicle_load_time", "max_route_distance"),
}  # fmt: skip
"""Data of OR-Tools' guides of routing, which are no fields of a class."""


def understood(name: str, table: str) -> bool:
    return ours(name, table) is not None or elsewhere(name, table) is not None


def parameters(made: Any) -> list[str]:
    return [name for name in inspect.signature(made).parameters if name not in PLAIN]


@pytest.mark.parametrize(("table", "kind"), [("sites", "client"), ("sites", "depot"), ("fleet", "vehicle_type")])
def test_fields_of_pyvrp(table: str, kind: str) -> None:
    model = pytest.importorskip("pyvrp").Model
    assert all(understood(name, table) for name in parameters(getattr(model, f"add_{kind}")))


def test_fields_of_vroom() -> None:
    vroom = pytest.importorskip("vroom")
    for table, made in (("sites", vroom.Job), ("fleet", vroom.Vehicle), ("shipments", vroom.Shipment)):
        assert [name for name in parameters(made.__init__) if not understood(name, table)] == []


def test_fields_of_vrpsolvereasy() -> None:
    solver = pytest.importorskip("VRPSolverEasy.src.solver")
    for table, made in (("sites", solver.Customer), ("fleet", solver.VehicleType)):
        assert [name for name in parameters(made.__init__) if not understood(name, table)] == []


@pytest.mark.parametrize(("table", "name"), [(table, name) for table, names in ROUTING_GUIDES.items() for name in names])
def test_data_of_the_routing_guides(table: str, name: str) -> None:
    assert understood(name, table)


@pytest.mark.parametrize(
    ("title", "own"),
    [
        ("tw_early", "ready"), ("TimeWindowStart", "ready"), ("time window start", "ready"), ("READY TIME", "ready"), ("TWEnd", "due"),
        ("DueDate", "due"), ("duedate", "due"), ("XCOORD.", "x"), ("prize", "reward"), ("Profit [EUR]", "reward"), ("weight_kg", "demand"),
        ("delivery2", "demand2"), ("customer_demand", "demand"), ("serviceTimeMinutes", "service"), ("is_depot", "depot"),
        ("mandatory", "required"), ("demand", "demand"), ("name", None), ("address", None), ("phone", None), ("note", None), ("city", None),
        ("delivery_demand", "demand"), ("DeliveryQuantity_1", "demand"), ("DeliveryQuantity_2", "demand2"), ("PickupQuantities", "pickup"),
        ("minStartTime", "ready"), ("maxEndTime", "due"), ("window_from", "ready"), ("window_to", "due"), ("from_time", "ready"),
        ("to_time", "due"), ("collect", "pickup"), ("vol", "demand"), ("kg", "demand"), ("utility", "reward"), ("size", None),
        ("lower", None), ("upper", None), ("", None), ("...", None), ("priority", None), ("min", None),
    ],
)  # fmt: skip
def test_case_spacing_units_and_numbers_do_not_matter(title: str, own: str | None) -> None:
    assert ours(title) == own


@pytest.mark.parametrize(
    ("table", "title", "told"),
    [
        ("sites", "unloading", "demand"), ("sites", "importance", "priorities"), ("sites", "disjunction", "groups"),
        ("sites", "disallowed_vehicles", "skills"), ("sites", "vehicles_allowed", "skills"), ("sites", "allowed_vehicle_indices", "skills"),
        ("sites", "preparation_time", "set-up"), ("sites", "max_tasks", "fleet"), ("sites", "start_late", "fleet"),
        ("fleet", "start_late", "latest departure"), ("fleet", "MaxOrderCount", "number of stops"),
    ],
)  # fmt: skip
def test_names_without_a_column_of_ours_say_what_to_do(table: str, title: str, told: str) -> None:
    assert ours(title, table) is None and told in (elsewhere(title, table) or "")


def test_each_name_means_one_thing_of_a_table() -> None:
    for table, names in OURS.items():
        meant = [name.replace("_", "") for own, others in names.items() for name in (own, *others.split())]
        told = [name.replace("_", "") for others in ELSEWHERE[table].values() for name in others.split()]
        assert sorted(meant + told) == sorted({*meant, *told})


def test_what_is_ours_is_ours() -> None:
    titles = {"sites": COLUMNS, "fleet": (*VEHICLE_KEYS, *SHIFT), **LISTS, "moves": MOVES}
    for table, names in OURS.items():
        assert set(names) <= set(titles[table])
        assert all(ours(title, table) in (title, None) and elsewhere(title, table) is None for title in titles[table])
    assert known("demand2") and ours("demand2") == "demand2"


def test_a_hint_is_a_name_a_reason_or_a_likely_misspelling() -> None:
    assert hint("tw_late", "fleet", VEHICLE_KEYS) == "; did you mean 'shift_end'?"
    assert hint("breaks", "fleet", VEHICLE_KEYS) == "; waybound has no breaks"
    assert hint("capcity", "fleet", VEHICLE_KEYS) == "; did you mean 'capacity'?" and hint("colour", "fleet", VEHICLE_KEYS) == ""
    assert may_be_another_load("Weight (kg)") and not may_be_another_load("delivery")
    assert foreign_names.UNITS.isdisjoint(COLUMNS)
