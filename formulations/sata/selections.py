"""Answers of selection and assignment problems: chosen elements, and actions of robots as JSON."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...instances.errors import InputError, UsageError
from ...instances.printable import printable
from ...instances.sata.sensing_graph import SensingGraph
from ..evaluation import Check, Violation, judge
from ..references import indices_of


@dataclass(frozen=True)
class Selection:
    """Chosen elements (actions of robots, sets, waypoints), numbered from 0.

    Parameters
    ----------
    elements : tuple of int
        The value does not depend on their order.
    winners : tuple of int, optional
        Winner takes all: the robot that is credited with each target, -1 for nobody. Without it, the best credit is meant.
    in_order : bool
        Whether ``elements`` stand in the order in which a method chose them one after the other; equal answers may differ in it.
    """

    elements: tuple[int, ...] = ()
    winners: tuple[int, ...] | None = None
    in_order: bool = field(default=False, compare=False)

    @classmethod
    def of(cls, elements: Iterable[int], winners: Iterable[int] | None = None) -> "Selection":
        """A selection from any whole numbers.

        Parameters
        ----------
        elements, winners : iterables of int
            As of the class.
        """
        try:
            chosen = tuple(int(e) for e in elements)
            credited = None if winners is None else tuple(int(w) for w in winners)
        except (TypeError, ValueError):
            raise UsageError(f"a selection is a list of element numbers, not {elements!r}", "malformed") from None
        return cls(chosen, credited)

    def __iter__(self) -> Iterator[int]:
        return iter(self.elements)

    def __len__(self) -> int:
        return len(self.elements)


def indicator(answer: Selection, size: int) -> NDArray[np.float64]:
    """1 for each chosen element, else 0; raises InputError where one does not exist."""
    x = np.zeros(size)
    elements = np.asarray(answer.elements, dtype=np.int64)
    if ((elements < 0) | (elements >= size)).any():
        raise InputError("the start chooses an element that does not exist", "unknown-name", expected=f"0 to {size - 1}")
    x[elements] = 1.0
    return x


def selection_of(answer: Any, names: Callable[[], Mapping[str, int]], thing: str) -> Selection:
    """``answer`` itself, or the selection that a list of indices or names stands for; raises UsageError for anything else."""
    if isinstance(answer, Selection) and all(isinstance(e, int | np.integer) for e in answer):
        return answer
    if isinstance(answer, str | bytes | Mapping) or hasattr(answer, "columns") or not isinstance(answer, Iterable):
        raise UsageError(
            f"{printable(repr(answer), 80)} is no list of {thing}s; Selection.of([0, 3]) chooses the first and the fourth", "malformed"
        )
    return Selection(tuple(indices_of(answer, names(), thing)))


def judge_elements(
    selection: Selection, count: int, check: str, thing: str, name_of: Callable[[int], str]
) -> tuple[NDArray[np.int64], tuple[Check, list[Violation]]]:
    """The elements that exist, ascending and each once; and the check that all ``count`` of them exist and none is chosen twice."""
    numbers = selection.elements
    existing = np.array([e if 0 <= e < count else -1 for e in numbers], dtype=np.int64)
    once, first = np.unique(existing, return_index=True)
    twice = np.ones(len(existing), dtype=bool)
    twice[first] = False

    def fault(k: int) -> str:
        return f"{thing} number {numbers[k]} does not exist" if existing[k] < 0 else f"{thing} {name_of(numbers[k])} is chosen twice"

    return once[once >= 0], judge(check, ((existing < 0) | twice).astype(np.float64), fault)


# -- robots and targets -----------------------------------------------------------------------------------------------


def graph_for(instance: Any, problem: str) -> SensingGraph:
    """The instance as a sensing graph of which ``problem`` may be asked; raises UsageError for any other."""
    if not isinstance(instance, SensingGraph):
        raise UsageError(f"{instance.name} holds no sensing graph, so it cannot be read as {problem}", "foreign")
    if problem not in instance.problems:
        allowed = ", ".join(instance.problems)
        raise UsageError(f"{instance.name} ({instance.format}) cannot be read as {problem}; it allows {allowed}", "foreign")
    return instance


def actions_to_json(graph: SensingGraph, answer: Selection) -> list[dict[str, str]]:
    """One entry a chosen action, with the file's own names."""
    return [{"robot": graph.robot_name(int(graph.robot_of_action[a])), "action": graph.action_name(a)} for a in answer.elements]


def action_index(graph: SensingGraph) -> dict[str, int]:
    """The index of each action by its name."""
    return {name: a for a, name in enumerate(graph.action_labels)}


def actions_from_json(graph: SensingGraph, data: Any) -> Selection:
    """Inverse of ``actions_to_json``; raises InputError for anything else."""
    if not isinstance(data, Mapping) or data.get("kind") != "assignment" or not isinstance(data.get("actions"), list):
        raise InputError("not an assignment of actions", expected='an object {"kind": "assignment", "actions": [{"action": ...}, ...]}')
    index = action_index(graph)
    chosen = []
    for number, entry in enumerate(data["actions"], start=1):
        name = entry.get("action") if isinstance(entry, Mapping) else None
        if str(name) not in index:
            raise InputError(f"entry {number} of the actions names no known action", "unknown-name", found=str(entry)[:80])
        action = index[str(name)]
        robot = graph.robot_name(int(graph.robot_of_action[action]))
        if "robot" in entry and str(entry["robot"]) != robot:
            raise InputError(f"action {name} belongs to robot {robot}", "contradiction", found=str(entry["robot"])[:80])
        chosen.append(action)
    return Selection(tuple(chosen))
