from typing import Any

import pytest

import waybound as wb
from waybound.formulations.problem import problem_from_instance
from waybound.instances.errors import InputError
from waybound.instances.instance import Instance


@pytest.fixture(autouse=True)
def module(own_modules: Any) -> Any:
    return own_modules("waybound.reports.benchmarks.made_problems")


@pytest.fixture
def instance() -> Instance:
    return wb.generate("random", customers=12, capacity=40).to_instance()


def test_one_customer_in_three_is_visited_each_with_those_nearest_to_a_centre(instance: Instance) -> None:
    groups = problem_from_instance(instance, "groups-of-three").sites.groups  # type: ignore[attr-defined]
    assert len(groups) == 4 and sorted(site for group in groups for site in group.sites) == list(range(1, 13))


def test_two_vehicles_come_back_for_more_within_their_length(module: Any, instance: Instance, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(module.LENGTHS, instance.name, 800)
    (vehicle,) = problem_from_instance(instance, "two-vehicles-with-reloads").fleet  # type: ignore[attr-defined]
    assert (vehicle.count, vehicle.reloads, vehicle.max_distance) == (2, (0,), 440.0)


def test_a_file_whose_length_is_not_known_is_refused(instance: Instance) -> None:
    with pytest.raises(InputError, match="no length is known"):
        problem_from_instance(instance, "two-vehicles-with-reloads")
