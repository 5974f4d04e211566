"""Persistent exploration: robots select views, share them out as routes, and extend these until the horizon, again and again."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from ....formulations.problem import Problem
from ....formulations.routing.objective import Composable, Makespan, Reward, TotalCost
from ....formulations.routing.problem import RoutingProblem
from ....instances.errors import UsageError
from ....instances.routing.instance import Sites, VehicleType
from ....instances.routing.occupancy import latest_start, way
from ....instances.routing.occupancy_maps import UTILITIES
from ....instances.routing.terrain import EDGE
from ....instances.routing.travel import EXPLICIT, Travel
from ....instances.routing.worlds.persistent_exploration import Cell, MapObservation, PersistentWorld
from ....instances.worlds import WORLDS, Setting, World, make_world, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene
from ._horizon import Horizon, Round


class PersistentExploration(Mission):
    """Keep the map of a changing place up to date: select, share out, extend, execute.

    Source: Mitchell (2020), chapters 3, 5 and 6; readings, parameters and errata: docs/missions/persistent-exploration.md.
    """

    name: ClassVar[str] = "persistent-exploration"
    summary: ClassVar[str] = "robots with small batteries keep the map of a changing place up to date"
    headline: ClassVar[str] = "entropy"
    lasting: ClassVar[int] = 300
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["persistent-exploration"].settings,
        "waypoints": Setting(6, "views that are selected at once", int, 1, 50),
        "advance": Setting(100.0, "time between two plans, s", float, 1.0, 1e5),
        "horizon": Setting(120.0, "plans are extended until so long from now, s", float, 1.0, 1e5),
        "utility": Setting("csqmi", "worth of a reading", choices=UTILITIES),
        "misfit-weight": Setting(150.0, "bits for a misfit of one a second of the window", float, 0.0, 1e9),
        "least": Setting(1e-3, "bits that a view must add to be selected", float, 0.0, 1e9),
        "spacing": Setting(2, "of views that may be selected, in cells", int, 1, 20),
        "free": Setting(0.3, "probability of occupied below which cells are flown through", float, 0.0, 0.5),
        "objective": Setting("makespan", "after the rewards, or mixed with them", choices=("makespan", "cost", "mixed")),
        "distance-weight": Setting(0.05, "pure-greedy: bits for a second of flight", float, 0.0, 1e9),
    }  # fmt: skip

    def world(self, seed: int, **settings: Any) -> PersistentWorld:
        self.values = setting_values(self.name, self.settings, settings)
        v = self.values
        if v["utility"] == "chi-square" and v["model"] != "markov":
            raise UsageError("utility chi-square needs model=markov: nothing counts transitions else")
        if not v["tick"] <= v["advance"] <= v["horizon"]:
            raise UsageError(
                f"advance must lie from tick to horizon, {v['tick']:g} to {v['horizon']:g}, not {v['advance']:g}", "out-of-range"
            )
        if abs(v["advance"] / v["tick"] - round(v["advance"] / v["tick"])) > 1e-9:
            raise UsageError(f"advance must be a multiple of tick, {v['tick']:g}, not {v['advance']:g}", "out-of-range")
        world = make_world(self.name, seed, **{key: v[key] for key in WORLDS[self.name].settings})
        assert isinstance(world, PersistentWorld)
        self.played, self._stops = world, dict[int, list[tuple[Cell, float]]]()
        Horizon(world.observe(), world, v, {})
        return world

    def teams(self, observation: MapObservation) -> Iterator[Round]:
        """Rounds of selection (algorithm 3), each after the one before has been shared out, until no plan can be extended."""
        v = self.values
        if observation.time % round(v["advance"] / v["tick"]):
            return
        self._horizon = h = Horizon(observation, self.played, v, self._stops)
        plans = h.plans
        while plans:
            chosen, added, at_most = h.selected(plans, v["waypoints"], v["least"])
            if not chosen:
                return
            cells = [(int(r), int(c)) for r, c in h.pool[chosen]]
            before = len(h.places)
            yield Round(cells, h.offered[chosen].sum(axis=1), plans, added, at_most)
            h.left[[k for k, cell in zip(chosen, cells, strict=True) if cell in h.places]] = False
            if len(h.places) == before:
                return
            plans = [plan for plan in h.plans if plan.stops and plan.end < v["horizon"]]

    def problem(self, observation: Round) -> Problem:
        """Share the waypoints out: optional sites, one depot for each robot in the air where it will be free (virtual nodes)."""
        h, o = self._horizon, observation
        aloft = sorted((plan for plan in o.plans if plan.stops or not plan.fresh), key=lambda plan: plan.end)
        fresh = sum(plan.fresh and not plan.stops for plan in o.plans)
        starts = [(h.o.base, 0.0), *((plan.cell, plan.end) for plan in aloft)]
        begin = [*(end for _, end in starts), *(h.tree[cell] * h.step for cell in o.chosen)]
        places = [*(cell for cell, _ in starts), *o.chosen]
        ways = [h.ways_from(cell, moment) for cell, moment in zip(places, begin, strict=True)]
        times = np.array([[steps[cell] for cell in places] for steps in ways]) * h.step
        times = np.where(times < 0, 2.0 * h.limit, times)
        times[:, 1 : len(starts)] = 2.0 * h.limit  # nobody flies to where another robot is
        times[: len(starts)] += np.array([end for _, end in starts])[:, None]
        np.fill_diagonal(times, 0.0)
        due = [latest_start([h.closes[c] for c in way(ways[k], h.o.base)], h.step) for k in range(len(starts), len(places))]
        count = len(starts)
        sites = Sites.of(
            ["base", *(f"robot {plan.robot + 1}" for plan in aloft), *(f"{r},{c}" for r, c in o.chosen)],
            depot=np.arange(len(places)) < count, required=np.zeros(len(places), dtype=bool),
            coordinates=np.array(places, dtype=np.float64),
            reward=np.concatenate([np.zeros(count), o.rewards]), due=np.concatenate([np.full(count, np.inf), due]),
        )  # fmt: skip
        fleet = [VehicleType(count=fresh, max_duration=h.limit, name="at the base")] if fresh else []
        for k, plan in enumerate(aloft, start=1):
            fleet.append(VehicleType(count=1, start=k, end=0, max_duration=h.limit - plan.used + plan.end, name=f"robot {plan.robot + 1}"))
        weight = float(o.rewards.min()) / h.limit
        objective: dict[str, Composable] = {
            "makespan": Reward().then(Makespan()), "cost": Reward().then(TotalCost()), "mixed": Reward() - weight * Makespan(),
        }  # fmt: skip
        named = "makespan-orienteering" if self.values["objective"] != "cost" else "team-orienteering"
        return RoutingProblem(
            sites,
            Travel(EXPLICIT, matrix=times),
            fleet,
            objective[self.values["objective"]],
            name=f"views at {h.o.clock:g} s",
            problem=named,
        )

    def actions(self, observation: Round, problem: Problem | None, answer: Any) -> Actions:
        h = self._horizon
        assert isinstance(problem, RoutingProblem)
        free = [plan for plan in observation.plans if plan.fresh and not plan.stops]
        by_name = {f"robot {plan.robot + 1}": plan for plan in observation.plans}
        first = len(problem.sites) - len(observation.chosen)
        for route in answer or ():
            if route.visits:
                name = problem.fleet[route.vehicle].name
                plan = free.pop(0) if name == "at the base" else by_name[name]
                for site in route.visits:
                    if not h.extend(plan, observation.chosen[site - first]):
                        break
        return self._told(h)

    def _told(self, h: Horizon) -> Actions:
        self._stops.update({plan.robot: plan.stops for plan in h.plans})
        return {plan.robot: (*plan.cells, *plan.home) for plan in h.plans if plan.cells or plan.home}

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``pure-greedy``: whoever comes to a waypoint takes the one of the most new worth less weighted time, (6.1); ``stay``."""
        return {"pure-greedy": self._pure_greedy, "stay": lambda o: {}}

    def _pure_greedy(self, o: MapObservation) -> Actions:
        v, assigned = self.values, False
        waiting = {k for k, state in enumerate(o.robots) if state.free or state.aloft} - {
            k for k, stops in self._stops.items() if any(moment >= o.clock + v["tick"] - 1e-6 for _, moment in stops)
        }
        if not waiting:
            return {}
        h = Horizon(o, self.played, v, self._stops)
        while plans := [plan for plan in h.plans if plan.robot in waiting and plan.end < v["tick"] - 1e-6]:
            plan = min(plans, key=lambda p: p.end)
            open_, out = h.reachable(plan)
            best = h.weights(h.places).max(axis=0) if h.places else 0.0
            score = np.where(open_, np.maximum(h.offered - best, 0.0).sum(axis=1) - v["distance-weight"] * out, -np.inf)
            k = int(score.argmax())
            h.left[k] = False
            if score[k] == -np.inf or not h.extend(plan, (int(h.pool[k, 0]), int(h.pool[k, 1]))):
                waiting.discard(plan.robot)
            else:
                assigned = True
        return self._told(h) if assigned else {}

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``selected``: views of all rounds of the step; ``assigned``: those that are on a route; ``selection_gap``: by how much all
        selections of the step may be below the best ones, percent of the bound."""
        rounds = [d for d in decisions if isinstance(d.view, Round)]
        on = sum(len(route.visits) for d in rounds for route in d.answer or ())
        most = math.fsum(d.view.at_most for d in rounds)
        gap = 100.0 * (1.0 - math.fsum(d.view.added for d in rounds) / most) if most > 0 else math.nan
        return {"selected": float(sum(len(d.view.chosen) for d in rounds)), "assigned": float(on), "selection_gap": gap}

    def scene(self, world: World) -> Scene:
        """Cells that are not known from the start, and how probable the map holds them to be occupied."""
        assert isinstance(world, PersistentWorld)
        open_, shape = ~world.terrain.known, world.truth.shape
        p = world.observe().p[open_]
        right = ((p > 0.5) == world.truth[open_]) & (np.abs(p - 0.5) > 0.3)
        robots = np.array([robot.cell[::-1] for robot in world.robots], dtype=np.float64)
        area = (-1.0, -1.0, float(shape[1]), float(shape[0]))
        labels = ("robots", "cells told rightly and surely", "others")
        return Scene(area, robots, self.values["reach"] / EDGE, np.argwhere(open_)[:, ::-1].astype(np.float64), right, labels)


MISSIONS.add("persistent-exploration", PersistentExploration)
