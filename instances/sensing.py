"""Sensing graphs: robots, the actions open to each, and the targets that each action would see."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError, UsageError
from .instance import digest

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]

PROBLEMS = ("bottleneck", "bottleneck-lp", "winner-takes-all", "selection")
"""What may be asked of a sensing graph; the first is meant when nothing else is said."""


class Incidence(NamedTuple):
    """One direction of a sparse graph: the partners of node k are ``indices[indptr[k]:indptr[k + 1]]``, in ascending order."""

    indptr: Indices
    indices: Indices
    weights: Floats


@dataclass(frozen=True, eq=False)
class SensingGraph:
    """Robots, their actions, targets, and the weight with which an action sees a target.

    ``from_edges`` makes one from any arrays; the constructor takes arrays that are in order already.

    Parameters
    ----------
    robot_of_action : array of shape (actions,)
        The robot that an action belongs to, from 0.
    indptr, indices, weights : arrays
        CSR form of actions x targets: ascending targets within an action, no pair twice, weights positive and finite.
    num_robots, num_targets : int
    robot_names, action_names, target_names : tuple of str, optional
        The file's own names; None stands for "1", "2", ... (actions: the position among the robot's own, after a dot: "3.1").
    action_positions, target_positions : arrays of shape (actions, 2) and (targets, 2), optional
        For maps.
    name, format, problem, problems, notes
        See ``Instance``. Idle robots and unseen targets are added to the notes.

    Raises
    ------
    InputError
        If an array has the wrong length, or holds what it must not.

    Notes
    -----
    Source: Sung (2019), Multi-Robot Coordination for Hazardous Environmental Monitoring, section 3.3; digest 2.1.
    """

    kind: ClassVar[str] = "sensing"
    robot_of_action: Indices
    indptr: Indices
    indices: Indices
    weights: Floats
    num_robots: int
    num_targets: int
    robot_names: tuple[str, ...] | None = None
    action_names: tuple[str, ...] | None = None
    target_names: tuple[str, ...] | None = None
    action_positions: Floats | None = None
    target_positions: Floats | None = None
    name: str = "sensing-graph"
    format: str = "arrays"
    problem: str = PROBLEMS[0]
    problems: tuple[str, ...] = PROBLEMS
    notes: tuple[str, ...] = field(default=())

    @classmethod
    def from_edges(
        cls,
        robot_of_action: ArrayLike,
        action: ArrayLike,
        target: ArrayLike,
        weight: ArrayLike = 1.0,
        *,
        robots: int | Sequence[str] | None = None,
        targets: int | Sequence[str] | None = None,
        duplicates: str = "error",
        action_names: Sequence[str] | None = None,
        action_positions: ArrayLike | None = None,
        target_positions: ArrayLike | None = None,
        name: str = "sensing-graph",
    ) -> SensingGraph:
        """A graph from arrays with one entry an action, and one entry an edge.

        Parameters
        ----------
        robot_of_action : array of shape (actions,)
            The robot of each action, from 0.
        action, target, weight : arrays of shape (edges,)
            Weight 0 means that the action does not see the target; a scalar weight holds for all edges.
        robots, targets : int or sequence of str, optional
            How many there are, or their names; by default as many as are named.
        duplicates : str
            What a pair of action and target that stands twice means: ``error`` or ``sum``.

        Raises
        ------
        InputError
            Naming the first action or edge that is wrong (counted from 0).
        UsageError
            If ``duplicates`` is neither.

        Warns
        -----
        UserWarning
            Of robots without an action that sees anything, and targets that nobody sees.
        """
        if duplicates not in ("error", "sum"):
            raise UsageError(f"duplicates must be error or sum, not {duplicates!r}")
        owner = _whole("robot_of_action", robot_of_action)
        a, t = _whole("action", action), _whole("target", target)
        c = np.array(np.broadcast_to(np.asarray(weight, dtype=np.float64), a.shape))
        if t.shape != a.shape:
            raise InputError("action and target must have one entry an edge", expected=str(len(a)), found=str(len(t)))
        counts, names = [], []
        for what, given, used in (("robots", robots, owner), ("targets", targets, t)):
            count, labels = _count(what, given, used)
            counts.append(count)
            names.append(labels)
        _refuse_outside("the action of edge {}", a, len(owner), "an action")
        _refuse_outside("the target of edge {}", t, counts[1], "a target")
        _refuse_outside("the robot of action {}", owner, counts[0], "a robot")
        wrong = ~(c >= 0) | np.isinf(c)
        if wrong.any():
            k = int(np.argmax(wrong))
            raise InputError(f"the weight of edge {k} must be finite and not negative", found=str(c[k]))
        key = a * np.int64(max(counts[1], 1)) + t
        if (np.diff(key) <= 0).any():
            order = np.argsort(key, kind="stable")
            key, c = key[order], c[order]
            first = np.concatenate([[True], np.diff(key) != 0])
            if not first.all():
                if duplicates == "error":
                    k = int(order[int(np.argmin(first))])
                    raise InputError(f'edge {k} joins action {a[k]} and target {t[k]} again; duplicates="sum" would add them up')
                c = np.add.reduceat(c, np.nonzero(first)[0])
                key = key[first]
            a, t = np.divmod(key, max(counts[1], 1))
        if not c.all():
            a, t, c = a[c > 0], t[c > 0], c[c > 0]
        indptr = np.zeros(len(owner) + 1, dtype=np.int64)
        np.cumsum(np.bincount(a, minlength=len(owner)), out=indptr[1:])
        made = cls(
            owner.astype(np.int32), indptr.astype(np.int32), t.astype(np.int32), c, counts[0], counts[1],
            names[0], None if action_names is None else tuple(action_names), names[1],
            _positions(action_positions), _positions(target_positions), name,
        )  # fmt: skip
        for note in made.notes:
            warnings.warn(note, stacklevel=2)
        return made

    def __post_init__(self) -> None:
        owner, n = self.robot_of_action, len(self.robot_of_action)
        if len(self.indptr) != n + 1 or self.indptr[0] != 0 or self.indptr[-1] != len(self.indices) or (np.diff(self.indptr) < 0).any():
            raise InputError("the starts of the actions do not ascend from 0 to the number of edges")
        if len(self.weights) != len(self.indices):
            raise InputError("there must be one weight an edge", expected=str(len(self.indices)), found=str(len(self.weights)))
        _refuse_outside("the robot of action {}", owner, self.num_robots, "a robot")
        _refuse_outside("the target of edge {}", self.indices, self.num_targets, "a target")
        if not (np.isfinite(self.weights).all() and (self.weights > 0).all()):
            raise InputError("weights must be positive and finite; an action that does not see a target has no edge to it")
        inside = np.ones(max(len(self.indices) - 1, 0), dtype=bool)
        inside[self.indptr[1:-1][(self.indptr[1:-1] > 0) & (self.indptr[1:-1] < len(self.indices))] - 1] = False
        if (np.diff(self.indices)[inside] <= 0).any():
            raise InputError("the targets of an action must ascend, none twice")
        for what, names, size in (
            ("robot", self.robot_names, self.num_robots), ("action", self.action_names, n), ("target", self.target_names, self.num_targets),
        ):  # fmt: skip
            if names is not None and (len(names) != size or len(set(names)) != size):
                raise InputError(f"there must be one name a {what}, no two alike", expected=str(size), found=str(len(set(names))))
        for what, points, size in (("action", self.action_positions, n), ("target", self.target_positions, self.num_targets)):
            if points is not None and (points.shape != (size, 2) or not np.isfinite(points).all()):
                raise InputError(f"{what} positions must be two finite numbers each", expected=f"({size}, 2)", found=str(points.shape))
        for values in (owner, self.indptr, self.indices, self.weights):
            values.setflags(write=False)
        found = (_few("robots without an action that sees anything", self.idle_robots, self.robot_name),
                 _few("targets that no action sees", self.unseen_targets, self.target_name))  # fmt: skip
        object.__setattr__(self, "notes", self.notes + tuple(n for n in found if n and n not in self.notes))

    # -- sizes -------------------------------------------------------------------------------------------------------

    @property
    def num_actions(self) -> int:
        return len(self.robot_of_action)

    @property
    def num_edges(self) -> int:
        return len(self.indices)

    @property
    def density(self) -> float:
        """Edges of all pairs of action and target, in percent: phi of (3.6)."""
        pairs = self.num_actions * self.num_targets
        return 100.0 * self.num_edges / pairs if pairs else 0.0

    # -- the other directions ----------------------------------------------------------------------------------------

    @property
    def by_action(self) -> Incidence:
        """Targets that each action sees."""
        return Incidence(self.indptr, self.indices, self.weights)

    @cached_property
    def by_target(self) -> Incidence:
        """Actions that see each target."""
        order = np.argsort(self.indices, kind="stable")
        starts = np.zeros(self.num_targets + 1, dtype=np.int32)
        np.cumsum(np.bincount(self.indices, minlength=self.num_targets), out=starts[1:])
        return Incidence(starts, self.action_of_edge[order], self.weights[order])

    @cached_property
    def action_of_edge(self) -> Indices:
        """The action of each edge, in the order of ``indices``."""
        return np.repeat(np.arange(self.num_actions, dtype=np.int32), np.diff(self.indptr))

    @cached_property
    def by_robot(self) -> tuple[Indices, Indices]:
        """``(indptr, actions)``: the actions of robot i are ``actions[indptr[i]:indptr[i + 1]]``, in ascending order."""
        starts = np.zeros(self.num_robots + 1, dtype=np.int32)
        np.cumsum(np.bincount(self.robot_of_action, minlength=self.num_robots), out=starts[1:])
        return starts, np.argsort(self.robot_of_action, kind="stable").astype(np.int32)

    @cached_property
    def idle_robots(self) -> Indices:
        """Robots none of whose actions sees a target."""
        seeing = np.zeros(self.num_robots, dtype=bool)
        seeing[self.robot_of_action[np.diff(self.indptr) > 0]] = True
        return np.nonzero(~seeing)[0].astype(np.int32)

    @cached_property
    def unseen_targets(self) -> Indices:
        """Targets that no action sees."""
        return np.nonzero(np.bincount(self.indices, minlength=self.num_targets) == 0)[0].astype(np.int32)

    # -- names -------------------------------------------------------------------------------------------------------

    def robot_name(self, robot: int) -> str:
        return str(robot + 1) if self.robot_names is None else self.robot_names[robot]

    def target_name(self, target: int) -> str:
        return str(target + 1) if self.target_names is None else self.target_names[target]

    def action_name(self, action: int) -> str:
        """The action's own name, or that of its robot and its position among the robot's actions: "3.1"."""
        if self.action_names is not None:
            return self.action_names[action]
        robot = int(self.robot_of_action[action])
        starts, actions = self.by_robot
        position = int(np.searchsorted(actions[starts[robot] : starts[robot + 1]], action))
        return f"{self.robot_name(robot)}.{position + 1}"

    def with_notes(self, *notes: str) -> SensingGraph:
        """The same graph with more to tell."""
        return replace(self, notes=self.notes + notes)

    def digest(self) -> str:
        """Hash of everything that values depend on; names and positions are not part of it."""
        return digest(
            "sensing", self.num_robots, self.num_targets, self.robot_of_action, self.indptr, self.indices, self.weights
        )  # fmt: skip

    def __repr__(self) -> str:
        return (
            f"<SensingGraph {self.name}: {self.num_robots} robots, {self.num_actions} actions, {self.num_targets} targets, "
            f"{self.num_edges} edges ({self.density:.3g} %)>"
        )


def _whole(what: str, values: ArrayLike) -> NDArray[np.int64]:
    array = np.asarray(values)
    if array.ndim != 1:
        raise InputError(f"{what} must be a list of whole numbers", found=f"shape {array.shape}")
    if array.size == 0:
        return np.zeros(0, dtype=np.int64)
    if array.dtype.kind not in "iu" and not (array.dtype.kind == "f" and (array == np.floor(array)).all()):
        raise InputError(f"{what} must be a list of whole numbers", found=str(array.dtype))
    return array.astype(np.int64)


def _count(what: str, given: int | Sequence[str] | None, used: NDArray[np.int64]) -> tuple[int, tuple[str, ...] | None]:
    if given is None:
        return int(used.max(initial=-1)) + 1, None
    if isinstance(given, int | np.integer) and not isinstance(given, bool):
        if given < 0:
            raise InputError(f"the number of {what} must not be negative", found=str(given))
        return int(given), None
    if isinstance(given, str | bool) or not isinstance(given, Sequence | np.ndarray):
        raise InputError(f"{what} must be a number or a list of names", found=repr(given)[:80])
    return len(given), tuple(str(g) for g in given)


def _refuse_outside(what: str, values: NDArray[Any], size: int, thing: str) -> None:
    outside = (values < 0) | (values >= size)
    if outside.any():
        k = int(np.argmax(outside))
        raise InputError(f"{what.format(k)} does not exist", expected=f"{thing} from 0 to {size - 1}", found=str(values[k]))


def _positions(points: ArrayLike | None) -> Floats | None:
    return None if points is None else np.array(points, dtype=np.float64)


def _few(what: str, members: Indices, label: Any) -> str:
    if not len(members):
        return ""
    shown = ", ".join(label(int(m)) for m in members[:5])
    return f"{len(members)} {what}: {shown}{', ...' if len(members) > 5 else ''}"
