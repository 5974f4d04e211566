"""Sensing graphs as tables of names, whatever holds the table.

A row has a robot, an action, a target and a weight: a full row is an edge. A row without a target declares an action that may see
nothing, one with a robot alone a robot that may have no actions, and one with a target alone a target that nobody may see.

Names of actions may be those of a robot's own ("left" of r1, "left" of r2). Where such a name stands with two robots, every action
is named after its robot and itself: "r1.left".
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import Code, InputError, UsageError
from ..number_arrays import Flags, Floats, Integers as Codes, row_starts

if TYPE_CHECKING:
    from .sensing_graph import SensingGraph


COLUMNS = ("robot", "action", "target", "weight")

ORDERS = ("names", "rows")
"""How robots, actions and targets are numbered: ``names``: in ascending order where all are whole numbers, else, and with ``rows``
always, in order of first appearance."""

_WHOLE = re.compile(r"[0-9]{1,18}\Z")


@dataclass(frozen=True)
class Named:
    """A column of names: the number of the name in each row, -1 where the cell is empty, and the names as they first appear."""

    codes: Codes
    labels: list[str]

    @classmethod
    def of(cls, cells: Iterable[str]) -> Named:
        """Names from the cells of a column, "" for an empty one."""
        number: dict[str, int] = {"": -1}
        codes = np.array([number.setdefault(cell, len(number) - 1) for cell in cells], dtype=np.int64)
        return cls(codes, list(number)[1:])


def reading_order(labels: Sequence[str], order: str) -> list[int]:
    """Order of names that are listed as they first appear; see ``ORDERS``."""
    if order == "names" and all(map(_WHOLE.match, labels)):
        return sorted(range(len(labels)), key=lambda k: (int(labels[k]), labels[k]))
    return list(range(len(labels)))


def edges_of_rows(
    robot: Named, action: Named, target: Named, weight: Floats | None, *, lines: Sequence[int] = (), place: Callable[[int], str] = str,
    order: str = "names", duplicates: str = "error", **further: Any,
) -> dict[str, Any]:  # fmt: skip
    """The arguments of ``graph_of_edges`` for the graph that a table of names stands for.

    ``weight`` has the shape (rows,), NaN where a row has none; without it every edge weighs 1. Messages name a row by its line, or by
    ``place`` from its number. Edges that stand twice are an ``error`` or a ``sum``; for ``order`` see ``ORDERS``.
    """
    if order not in ORDERS:
        raise UsageError(f"order must be one of {', '.join(ORDERS)}, not {order!r}", "unknown-name")
    if duplicates not in ("error", "sum"):
        raise UsageError(f"duplicates must be error or sum, not {duplicates!r}", "unknown-name")
    has_robot, has_action, has_target = (column.codes >= 0 for column in (robot, action, target))
    edge = has_robot & has_action & has_target

    def refuse(bad: Flags, message: str, code: Code, values: Any = None) -> None:
        if bad.any():
            k = int(np.argmax(bad))
            raise fault(k, message, code, None if values is None else str(values[k]))

    def fault(k: int, message: str, code: Code, found: str | None = None) -> InputError:
        return InputError(message, code, line=lines[k], found=found) if lines else InputError(f"{place(k)}: {message}", code, found=found)

    refuse(~(has_robot | has_action | has_target), "neither a robot nor a target is named", "missing")
    refuse(has_action & ~has_robot, "the action has no robot", "missing")
    refuse(has_robot & has_target & ~has_action, "a robot and a target are named, but no action", "missing")
    if weight is None:
        weight = np.where(edge, 1.0, np.nan)
    refuse(~edge & ~np.isnan(weight), "a weight stands in a row that is no edge", "contradiction", weight)
    refuse(edge & (~(weight >= 0) | np.isinf(weight)), "the weight must be a finite number, not negative", "out-of-range", weight)

    robots, robot_of = _numbered(robot.labels, order)
    targets, target_of = _numbered(target.labels, order)
    actions, owner, action_of = _actions(robot, action, robots, robot_of, order)
    at = np.nonzero(edge)[0]
    a, t = action_of[at], target_of[target.codes[at]]
    if duplicates == "error":
        key = a * np.int64(max(len(targets), 1)) + t
        ranked = np.argsort(key, kind="stable")
        again = np.nonzero(np.diff(key[ranked]) == 0)[0]
        if len(again):
            first = again[np.argmin(ranked[again + 1])]
            earlier, later = int(at[ranked[first]]), int(at[ranked[first + 1]])
            where = f"line {lines[earlier]}" if lines else place(earlier)
            raise fault(later, f'the edge stands already in {where}; duplicates "sum" would add them up', "duplicate")
    return {
        "robot_of_action": owner, "action": a, "target": t, "weight": weight[at], "robots": unless_counted(robots),
        "targets": unless_counted(targets), "duplicates": duplicates, "action_names": unless_usual(actions, owner, robots), **further,
    }  # fmt: skip


def _numbered(labels: list[str], order: str) -> tuple[list[str], Codes]:
    """Names in their order, and the place of each in it."""
    ranked = reading_order(labels, order)
    place = np.empty(len(ranked), dtype=np.int64)
    place[ranked] = np.arange(len(ranked))
    return [labels[k] for k in ranked], place


def _actions(robot: Named, action: Named, robots: list[str], robot_of: Codes, order: str) -> tuple[list[str], Codes, Codes]:
    """Names and robots of the actions in their order, and the action of each row, -1 where it names none."""
    named = action.codes >= 0
    action_of = np.full(len(action.codes), -1, dtype=np.int64)
    if not named.any():
        return [], np.zeros(0, dtype=np.int64), action_of
    size = np.int64(len(action.labels))
    pairs, first, inverse = np.unique(robot.codes[named] * size + action.codes[named], return_index=True, return_inverse=True)
    appearing = np.argsort(first, kind="stable")
    owner = robot_of[pairs[appearing] // size]
    labels = [action.labels[code] for code in (pairs[appearing] % size).tolist()]
    if len(pairs) > size:
        labels = [f"{robots[r]}.{label}" for r, label in zip(owner.tolist(), labels, strict=True)]
    ranked = np.array(reading_order(labels, order), dtype=np.int64)
    place = np.empty(len(pairs), dtype=np.int64)
    place[appearing[ranked]] = np.arange(len(pairs))
    action_of[named] = place[inverse]
    return [labels[k] for k in ranked.tolist()], owner[ranked], action_of


def unless_counted(labels: list[str]) -> int | list[str]:
    """The names, or their number where they are "1", "2", ..., as they are without names."""
    return len(labels) if all(label == str(k) for k, label in enumerate(labels, start=1)) else labels


def unless_usual(labels: list[str], owner: Codes, robots: list[str]) -> list[str] | None:
    """The names of actions, or None where they are those that actions have without names."""
    order = np.argsort(owner, kind="stable")
    starts = row_starts(owner, len(robots))
    position = np.empty(len(owner), dtype=np.int64)
    position[order] = np.arange(len(owner)) - starts[owner[order]]
    usual = (f"{robots[r]}.{k + 1}" for r, k in zip(owner.tolist(), position.tolist(), strict=True))
    return None if all(a == b for a, b in zip(labels, usual, strict=True)) else labels


# -- the way back -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rows:
    """A graph as rows of numbers, -1 and NaN for empty cells; ``order`` is the one that reads them back as the same graph."""

    robot: Codes
    action: Codes
    target: Codes
    weight: Floats
    order: str = "names"


def rows_of_graph(graph: SensingGraph) -> Rows:
    """A row for each edge in order, and one for each action, robot and target that no edge names."""
    degree = np.diff(graph.indptr)
    action = np.repeat(np.arange(graph.num_actions), np.maximum(degree, 1))
    edge = np.repeat(degree > 0, np.maximum(degree, 1))
    target, weight = np.full(len(action), -1, dtype=np.int64), np.full(len(action), np.nan)
    target[edge], weight[edge] = graph.indices, graph.weights
    still = np.nonzero(np.bincount(graph.robot_of_action, minlength=graph.num_robots) == 0)[0]
    below = _declaring(still, graph.unseen_targets.astype(np.int64))
    return _joined(Rows(graph.robot_of_action[action].astype(np.int64), action, target, weight), below)


def exact_rows(graph: SensingGraph) -> Rows:
    """``rows_of_graph``; and where the order of names would number the graph otherwise, rows above them that name all robots and
    targets in their order, for the order ``rows``."""
    rows = rows_of_graph(graph)
    for codes, label in (
        (rows.robot, graph.robot_name), (rows.action, graph.action_labels.__getitem__), (rows.target, graph.target_name),
    ):  # fmt: skip
        used, first = np.unique(codes[codes >= 0], return_index=True)
        appearing = used[np.argsort(first, kind="stable")]
        ranked = reading_order([label(k) for k in appearing.tolist()], "names")
        if not np.array_equal(appearing[ranked], np.arange(len(used))):
            listed = _joined(_declaring(np.arange(graph.num_robots), np.arange(graph.num_targets)), rows)
            return Rows(listed.robot, listed.action, listed.target, listed.weight, "rows")
    return rows


def _declaring(robots: Codes, targets: Codes) -> Rows:
    none, count = np.full(len(robots) + len(targets), -1, dtype=np.int64), len(robots)
    return Rows(
        np.concatenate([robots, none[count:]]), none, np.concatenate([none[:count], targets]), np.full(len(none), np.nan)
    )  # fmt: skip


def _joined(above: Rows, below: Rows) -> Rows:
    robot, action, target, weight = (np.concatenate([getattr(above, key), getattr(below, key)]) for key in COLUMNS)
    return Rows(robot, action, target, weight)
