"""Exploring, mapping and searching by a team with budgets that must be heard again and again, and knows what it was told."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, ClassVar

import numpy as np

from ....formulations.auctions.room_exploration import RoomExploration
from ....formulations.problem import Problem
from ....heuristics.auctions._exploration import explorers_and_relays
from ....instances.auctions.beliefs import Floats, Integers, capacity, posterior
from ....instances.auctions.generators.exploration_map import TIMES
from ....instances.auctions.worlds.explore_map_search import TeamObservation, TeamWorld
from ....instances.auctions.worlds.room_exploration import GO, MAP, SEARCH
from ....instances.worlds import WORLDS, Setting, World, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene
from .room_exploration import rooms_scene, round_problem, worth_now


class ExploreMapSearch(Mission):
    """Gain as much as the budgets allow: rooms entered, types learnt, targets found, by their weights.

    Source: Zhang (2015), chapter 5; readings and errata: docs/missions/explore-map-search.md.
    """

    name: ClassVar[str] = "explore-map-search"
    summary: ClassVar[str] = "robots with budgets explore, map and search rooms, and know what they read or were told"
    headline: ClassVar[str] = "utility"
    lasting: ClassVar[int] = 1_000_000
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["explore-map-search"].settings,
        "horizon": Setting(6, "steps that are planned at once, from contact to contact", int, 1, 1000),
        "replan": Setting(3, "steps after which a new plan is made as soon as all have contact", int, 1, 1000),
        "update": Setting("joint", "of beliefs: type and target as one, or the marginals in turn", choices=("joint", "marginal")),
    }  # fmt: skip

    def world(self, seed: int, **settings: Any) -> TeamWorld:
        return self.begin(self.made(TeamWorld, seed, settings))

    def begin(self, world: TeamWorld) -> TeamWorld:
        """Play in a world that was made elsewhere; the settings are those of ``world``, or the defaults."""
        if not hasattr(self, "values"):
            self.values = setting_values(self.name, self.settings, {})
        self.played = world
        self._plan: Sequence[Sequence[tuple[int, int]]] = ()
        self._planned = -int(self.values["replan"])
        self._teams: dict[int, tuple[int, ...]] = {}
        return world

    def known(self, o: TeamObservation, robot: int) -> tuple[Floats, Integers]:
        """Beliefs and visits of all rooms by what a robot, or the base (-1), has read or was told; shapes (rooms, types, 2), (rooms,)."""
        rooms, types = o.building.num_rooms, len(self.played.prior)
        readings = o.history[np.arange(len(o.history))[:, None] < o.knows[robot]].reshape(-1, 3)
        count = np.zeros((3, rooms, types), dtype=np.int64)
        np.add.at(count, (readings[:, 1], readings[:, 0], readings[:, 2]), 1)
        visits = count[GO, :, 1]
        visits[np.unique(o.building.starts)] += 1
        beliefs = posterior(
            self.played.prior, self.played.sensing, count[MAP], count[SEARCH, :, :2], joint=self.values["update"] == "joint"
        )  # fmt: skip
        return beliefs, visits

    def problem(self, observation: TeamObservation) -> Problem | None:
        """The static problem of the next steps; None between plans, and where somebody has no contact."""
        o = observation
        if o.silent.any() or o.time < self._planned + min(self.values["replan"], self.values["horizon"]):
            return None
        beliefs, visits = self.known(o, -1)
        tables = self.played.rewards.tables(beliefs, visits, self.played.sensing, TIMES)
        return round_problem(o.building, tables, o.robots, min(self.values["horizon"], o.left), f"rooms at step {o.time}")

    def actions(self, observation: TeamObservation, problem: Problem | None, answer: Any) -> Actions:
        """The plan's next step; all stay where there is none."""
        if problem is not None:
            self._plan, self._planned = answer or (), observation.time
        now = observation.time - self._planned
        return {robot: deeds[now] for robot, deeds in enumerate(self._plan) if now < len(deeds)}

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``alone`` and ``relays``: see ``explorers_and_relays``."""
        return {"alone": partial(self._by_rule, False), "relays": partial(self._by_rule, True)}

    def _by_rule(self, relays: bool, o: TeamObservation) -> Actions:
        w, building = self.played, o.building
        actions: dict[int, tuple[int, int]] = {}
        teams: dict[int, tuple[int, ...]] = {}
        adjacent, linked = building.adjacent, building.linked
        for group in np.unique(o.groups[:-1]):
            members = np.nonzero(o.groups[:-1] == group)[0].tolist()
            number = {robot: k for k, robot in enumerate(members)}
            worth = worth_now(w.rewards, *self.known(o, members[0]), w.sensing)
            own = {number[robot]: tuple(number[u] for u in others) for robot, others in self._teams.items() if robot in number}
            deeds, kept = explorers_and_relays(
                adjacent, linked, building.base, o.robots[members].tolist(), o.silent[members].tolist(), building.silence, worth, own,
                relays=relays,
            )  # fmt: skip
            actions.update((members[k], deed) for k, deed in deeds.items())
            teams.update((members[k], tuple(members[u] for u in others)) for k, others in kept.items())
        self._teams = teams
        return actions

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``planned``: steps of the plan made in this step, 0 between plans."""
        return {"planned": float(sum(d.problem.instance.steps for d in decisions if isinstance(d.problem, RoomExploration)))}

    def scene(self, world: World) -> Scene | None:
        assert isinstance(world, TeamWorld)
        return rooms_scene(world)


def most_gain(world: TeamWorld) -> RoomExploration:
    """A static problem whose optimum is no less than the utility of any team in a world at its start.

    Each reading gains what its sensor can tell at most, whatever is believed. A robot may be without contact when the budget ends, but can
    still come back in time, as the missions' plans and policies see to: the problem has as many more steps as robots may be silent.
    """
    building, rewards = world.building, world.rewards
    steps = world.steps + building.silence
    next_visits = world.visits[:, None] + np.arange(building.num_robots * steps)
    tables = [np.asarray(rewards.explore(next_visits))]
    for weight, readings in zip(rewards.weights[1:], (world.sensing.types, world.sensing.targets), strict=True):
        most = np.log(len(readings)) if rewards.gain == "entropy" else capacity(readings)
        tables.append(np.full(next_visits.shape, weight * most))
    return round_problem(building, tables, world.robots, steps, "most gain")


MISSIONS.add("explore-map-search", ExploreMapSearch)
