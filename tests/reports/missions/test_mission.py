import math
from typing import Any

import pytest

import waybound as wb
from waybound.reports.missions.mission import MISSIONS, Decision, Mission, Scene


class Idle(Mission):
    """Decides nothing."""

    name, summary, headline = "idle", "for tests", "seen"

    def world(self, seed: int, **settings: Any) -> Any:
        return None

    def problem(self, observation: Any) -> None:
        return None

    def actions(self, observation: Any, problem: Any, answer: Any) -> dict[int, Any]:
        return {}


class Seen(Idle):
    def scene(self, world: Any) -> Scene | None:
        return None


def test_all_decide_together_and_by_no_rule() -> None:
    mission, view = Idle(), object()
    assert list(mission.teams(view)) == [view]
    assert mission.policies() == {} and mission.measures([], None) == {} and mission.scene(None) is None  # type: ignore[arg-type]


def test_values_of_teams_are_added_up_without_a_rounding_lost() -> None:
    assert Idle().total([0.1] * 10) == 1.0 == math.fsum([0.1] * 10)
    assert Idle().total([]) == 0.0


def test_a_mission_that_can_draw_says_so() -> None:
    assert not Idle().drawable and Seen().drawable


def test_a_step_in_which_nothing_was_decided_has_no_answer() -> None:
    assert Decision("view", None, None).answer is None


def test_a_mission_that_cannot_begin_decide_or_act_is_none() -> None:
    for missing in ("world", "problem", "actions"):
        with pytest.raises(TypeError, match=missing):
            type("Half", (Idle,), {missing: getattr(Mission, missing)})()


@pytest.mark.parametrize("name", list(MISSIONS))
def test_every_mission_says_what_it_is_and_begins_with_its_defaults(name: str) -> None:
    mission = MISSIONS[name]()
    assert mission.name == name and mission.summary and "\n" not in mission.summary and mission.headline
    world = mission.world(1)
    assert mission.headline in world.metrics()
    assert all(setting.help for setting in mission.settings.values())
    assert mission.drawable == (mission.scene(world) is not None)


SHORT = {
    "explore-map-search": {"robots": 3, "steps": 30},
    "fire-monitoring": {"size": 40, "begin": 30, "steps": 8},
    "fleet-energy": {"steps": 80},
    "persistent-exploration": {"rows": 17, "columns": 17, "robots": 2, "steps": 15},
    "plume-exploration": {"cells": 30, "robots": 4},
    "search-and-track": {"steps": 40, "robots": 2, "plan_every": 10, "target_step": 0.05},
    "tracking": {"steps": 6, "robots": 4, "targets": 6, "width": 80.0, "height": 80.0},
    "unreliable-communication": {
        "map": "rooms", "room": 2, "width": 13, "height": 9, "robots": 2, "battery": 20, "sight": 0, "reach": 3,
    },
}  # fmt: skip
DECIDED = {
    "explore-map-search": {"policy": ("relays",)},
    "fire-monitoring": {"policy": ("weighted-greedy", "exact"), "heuristic": ("pure-greedy",)},
    "fleet-energy": {"policy": ("one-by-one",), "solver": ("highs",)},
    "persistent-exploration": {"policy": ("pure-greedy",), "heuristic": ("greedy-assignment",)},
    "plume-exploration": {"policy": ("depth-first",), "heuristic": ("greedy-assignment",)},
    "search-and-track": {
        "policy": ("lawn-mower", "largest-gaussian", "nearest-gaussian", "stay"), "solver": ("highs",), "heuristic": ("sequential-greedy",),
    },
    "tracking": {"heuristic": ("random",)},
    "unreliable-communication": {"policy": ("nearest-frontier",), "heuristic": ("greedy-assignment", "pure-greedy")},
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "by", "who"), [(name, by, who) for name, ways in DECIDED.items() for by, names in ways.items() for who in names]
)
def test_the_same_seed_gives_the_same_log_to_the_bit(name: str, by: str, who: str) -> None:
    one, two = (wb.run(name, seed=4, **SHORT[name], **{by: who}) for _ in range(2))
    assert (one["seconds"] >= 0).all() and one["seconds"].sum() > 0
    assert one.drop(columns="seconds").equals(two.drop(columns="seconds"))
