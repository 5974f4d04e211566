"""The contract of missions: how an observation becomes a problem, and an answer becomes actions."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...formulations.problem import Problem
from ...formulations.solution import Solution
from ...instances.registry import Registry
from ...instances.worlds import WORLDS, Setting, World, make_world, setting_values

W = TypeVar("W", bound=World)

Actions = Mapping[int, Any]
"""Action of each agent by its number; agents that are not named do nothing."""


@dataclass(frozen=True, eq=False)
class Decision:
    """A team's decision in one step: its observation, problem and solution.

    Parameters
    ----------
    view : object
        The team's observation.
    problem : Problem or None
        None where there was nothing to decide.
    solution : Solution or None
    """

    view: Any
    problem: Problem | None
    solution: Solution | None

    @property
    def answer(self) -> Any:
        """The verified answer, if there is one."""
        return None if self.solution is None else self.solution.answer


@dataclass(frozen=True, eq=False)
class Scene:
    """One picture of a world.

    Parameters
    ----------
    area : tuple of float
        Left, bottom, right, top.
    agents : array of shape (agents, 2)
    reach : float
        Radius of the disc that each agent sees.
    points : array of shape (points, 2)
    marked : bool array of shape (points,)
        Points that are attained: seen, visited, done.
    labels : tuple of str
        What agents, marked points and the other points are.
    headings : array of shape (agents,), radians, optional
        Where agents face.
    links : sequence of (agent, point)
        Which points are assigned to which agent, by what was decided last.
    ways : sequence of (point, point)
        Points of the first picture that ways lead between, where not all of the area can be gone through.
    levels : array of shape (points,), optional
        How full each point is, from 0 to 1.
    notes : sequence of str
        A few characters beside each agent.
    shares : array of shape (agents,), optional
        What each agent has added to the headline so far; agents have colours of their own then.
    limit : float, optional
        What the headline could be at most by now.
    """

    area: tuple[float, float, float, float]
    agents: NDArray[np.float64]
    reach: float
    points: NDArray[np.float64]
    marked: NDArray[np.bool_]
    labels: tuple[str, str, str] = ("agents", "attained", "open")
    headings: NDArray[np.float64] | None = None
    links: Sequence[tuple[int, int]] = ()
    ways: Sequence[tuple[int, int]] = ()
    levels: NDArray[np.float64] | None = None
    notes: Sequence[str] = ()
    shares: NDArray[np.float64] | None = None
    limit: float | None = None


class Mission(ABC):
    """A sequence of decisions in a world. ``run`` plays it; the solver or heuristic that decides is the user's choice.

    A mission object plays one run at a time: ``world`` begins it.

    Class attributes
    ----------------
    name : str
    summary : str
        One line.
    settings : mapping of Setting
        What a user may choose, the world's settings included.
    headline : str
        The metric that pictures and summaries show first.
    lasting : int
        Steps that are played where none are asked for; fewer if the world is over before.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    settings: ClassVar[Mapping[str, Setting]] = {}
    headline: ClassVar[str]
    lasting: ClassVar[int] = 100
    values: dict[str, Any]

    @abstractmethod
    def world(self, seed: int, **settings: Any) -> World:
        """Begin a run: the world at its start. The same seed and settings give the same run.

        Raises
        ------
        UsageError
            For a setting that does not exist, or a value out of range.
        """

    def made(self, kind: type[W], seed: int, settings: Mapping[str, Any]) -> W:
        """The world of the mission's name, by the seed and its part of ``settings``; ``values`` are these and the defaults of others."""
        self.values = setting_values(self.name, self.settings, settings)
        world = make_world(self.name, seed, **{key: self.values[key] for key in WORLDS[self.name].settings})
        assert isinstance(world, kind)
        return world

    def teams(self, observation: Any) -> Iterable[Any]:
        """The observation in parts, one for each group of agents that decides by itself; by default, one team of all."""
        return [observation]

    @abstractmethod
    def problem(self, observation: Any) -> Problem | None:
        """The problem that one team has to solve; None where there is nothing to decide."""

    @abstractmethod
    def actions(self, observation: Any, problem: Problem | None, answer: Any) -> Actions:
        """The actions of the team's agents. ``problem`` is None where there was none, ``answer`` where the solver found none."""

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """Rules that act without a problem, by name: from the whole observation to what the agents do."""
        return {}

    def total(self, values: Sequence[float]) -> float:
        """The value of all teams together, from the values (or bounds) of their problems."""
        return math.fsum(values)

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """Figures of a step beyond the world's metrics, from what was decided and the world after it; always the same names."""
        return {}

    def scene(self, world: World) -> Scene | None:
        """A picture of the world; None if the mission cannot be drawn."""
        return None

    @property
    def drawable(self) -> bool:
        """True if it has pictures."""
        return type(self).scene is not Mission.scene


MISSIONS: Registry[Callable[[], Mission]] = Registry("mission", "waybound.reports.missions.*", group="waybound.missions")
