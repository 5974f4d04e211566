"""Worlds: instances that unfold over time, as seeded state machines of pure data. Each module registers one."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import InputError, UsageError
from .generators.settings import Setting as Setting
from .registry import Registry
from .suggestions import did_you_mean


class World(ABC):
    """A state that agents see a part of, and change by what they do.

    A world knows no problem and no solver. All its randomness comes from the generator that it was made with, and how much of it a
    step uses must not depend on what the agents do: then two runs from one seed meet the same world, whatever decides in them.

    Attributes
    ----------
    time : int
        Steps taken so far.
    """

    time: int = 0

    @abstractmethod
    def observe(self) -> Any:
        """The knowledge of the agents now. Asking twice between two steps gives the same."""

    @abstractmethod
    def step(self, actions: Mapping[int, Any]) -> None:
        """Let one step pass, in which each agent (by its number) does what ``actions`` says; the others do nothing.

        Raises
        ------
        InputError
            If an agent does not exist or cannot do that; the world has not changed then.
        """

    @abstractmethod
    def metrics(self) -> dict[str, float]:
        """Figures of the present state, always under the same names."""

    @property
    def over(self) -> bool:
        """Whether the world has come to its end, if it has one."""
        return False


@dataclass(frozen=True)
class WorldKind:
    """A kind of world.

    Parameters
    ----------
    name : str
    summary : str
        One line.
    settings : mapping of Setting
        What a user may choose.
    make : callable
        From a generator of random numbers and one value for each setting to the world at its start.
    """

    name: str
    summary: str
    settings: Mapping[str, Setting]
    make: Callable[["np.random.Generator", Mapping[str, Any]], World]


def check_robot(robot: Any, count: int) -> None:
    """Raise InputError unless ``robot`` is the number of one of ``count`` robots, from 0."""
    if not isinstance(robot, int) or not 0 <= robot < count:
        raise InputError("there is no such robot", "unknown-name", expected=f"0 to {count - 1}", found=str(robot)[:40])


def setting_values(who: str, settings: Mapping[str, Setting], values: Mapping[str, Any]) -> dict[str, Any]:
    """A value for each of ``settings``, from ``values`` or by default; dashes and underscores are one; UsageError for another name."""
    named = {key.replace("_", "-"): value for key, value in values.items()}
    for key in named:
        if key not in settings:
            raise UsageError(f"{who} has no setting {key!r}; it takes {', '.join(settings)}{did_you_mean(key, settings)}", "unknown-name")
    return {key: setting.value(key, named[key]) if key in named else setting.default for key, setting in settings.items()}


def make_world(kind: str, seed: int, **settings: Any) -> World:
    """A world of ``WORLDS`` at its start; the same seed and settings give the same world. Values may be text, as on the command line."""
    recipe = WORLDS[kind]
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise UsageError(f"the seed must be a whole number of at least 0, not {seed!r}", "out-of-range")
    return recipe.make(np.random.Generator(np.random.PCG64(int(seed))), setting_values(kind, recipe.settings, settings))


WORLDS: Registry[WorldKind] = Registry("world", "waybound.instances.*.worlds", group="waybound.worlds")
