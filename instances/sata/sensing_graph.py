"""Sensing graphs: robots, the actions open to each, and the targets that each action would see."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..declared import CountOf, Declared, NameOf, Names, extent
from ..document import fields, json_numbers, reals, wholes
from ..errors import InputError, UsageError
from ..number_arrays import Floats
from ..parts import Axis, Count, Wholes

if TYPE_CHECKING:
    import pandas as pd

Indices = NDArray[np.int32]

PROBLEMS = ("bottleneck", "bottleneck-lp", "winner-takes-all", "selection")
"""Problems that a sensing graph allows; the first is the default."""

EDGE_KEYS = ("action", "target", "weight")
"""Columns of edges in JSON."""


class Incidence(NamedTuple):
    """One direction of a sparse graph: the partners of node k are ``indices[indptr[k]:indptr[k + 1]]``, in ascending order."""

    indptr: Indices
    indices: Indices
    weights: Floats


@dataclass(frozen=True, eq=False, repr=False)
class SensingGraph(Declared):
    """Robots, their actions, targets, and the weight with which an action sees a target.

    ``from_edges``, ``from_frames``, ``from_networkx`` and ``from_positions`` make one; the constructor takes arrays that are
    in order already.

    Parameters
    ----------
    robot_of_action : array of shape (actions,)
        The robot that an action belongs to, from 0.
    indptr, indices, weights : arrays
        CSR form of actions x targets: ascending targets within an action, no pair twice, weights positive and finite.
    num_robots, num_targets : int
        Those included that have no action, or that nobody sees.
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
    Source: Sung (2019), Multi-Robot Coordination for Hazardous Environmental Monitoring, section 3.3;
    docs/formulations/sensing.md#model.
    """

    kind = "sensing"
    problem_names = PROBLEMS
    lists_problems = True
    content = "sensing graphs"
    default_name = "sensing-graph"
    axes = (
        Axis("robot", least=0),
        Axis("action", least=0, counted=False, positions="action_positions"),
        Axis("target", least=0, positions="target_positions"),
    )
    own_keys = ("edges",)
    hashed = ("num_robots", "num_targets", "robot_of_action", "indptr", "indices", "weights")
    robot_of_action: Annotated[Indices, Wholes("action", "robot", "the robot of action {}", small=True, key="robot")]
    indptr: Indices
    indices: Indices
    weights: Floats
    num_robots: Annotated[int, Count("robot")]
    num_targets: Annotated[int, Count("target")]
    robot_names: Names = None
    action_names: Names = None
    target_names: Names = None
    action_positions: Floats | None = None
    target_positions: Floats | None = None
    num_actions = CountOf("action")
    robot_name, target_name = NameOf("robot"), NameOf("target")

    @classmethod
    def from_edges(
        cls,
        robot_of_action: ArrayLike,
        action: ArrayLike,
        target: ArrayLike,
        weight: ArrayLike = 1.0,
        *,
        robots: int | Iterable[str] | None = None,
        targets: int | Iterable[str] | None = None,
        duplicates: str = "error",
        action_names: Iterable[str] | None = None,
        action_positions: ArrayLike | None = None,
        target_positions: ArrayLike | None = None,
        name: str = "sensing-graph",
    ) -> SensingGraph:
        """A graph from arrays with one entry per action, and one entry per edge.

        Parameters
        ----------
        robot_of_action : array of shape (actions,)
            The robot of each action, from 0.
        action, target, weight : arrays of shape (edges,)
            Weight 0 means that the action does not see the target; a scalar weight holds for all edges.
        robots, targets : int or iterable of str, optional
            How many there are, or their names; by default as many as are named.
        duplicates : str
            What a pair of action and target that stands twice means: ``error`` or ``sum``.
        action_names, action_positions, target_positions, name
            See ``SensingGraph``.

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
        return _warned(
            graph_of_edges(
                robot_of_action, action, target, weight, robots=robots, targets=targets, duplicates=duplicates, action_names=action_names,
                action_positions=action_positions, target_positions=target_positions, name=name,
            )
        )  # fmt: skip

    @classmethod
    def from_frames(
        cls, edges: pd.DataFrame, actions: pd.DataFrame | None = None, *, duplicates: str = "error", order: str = "names",
        name: str = "sensing-graph",
    ) -> SensingGraph:  # fmt: skip
        """A graph from pandas frames, with the frames' own names.

        Parameters
        ----------
        edges : DataFrame
            Columns ``robot``, ``action``, ``target`` and, unless all weights are 1, ``weight``; one row per edge.
        actions : DataFrame, optional
            Columns ``robot`` and ``action``: robots and actions that may see nothing; the action is empty for a robot without actions.
        duplicates : str
            Edges that stand twice: ``error`` or ``sum``.
        order : str
            How robots, actions and targets are numbered: ``names``: where all are whole numbers, in ascending order, else, and with
            ``rows`` always, as they first appear, in ``actions`` and then in ``edges``.
        name : str
            For tables and files.

        Raises
        ------
        InputError
            Naming the column or row (counted from 0) that is wrong.
        """
        from .sensing_sources import edges_from_frames

        return _warned(graph_of_edges(**edges_from_frames(edges, actions, duplicates=duplicates, order=order, name=name)))

    @classmethod
    def from_networkx(cls, graph: Any, *, duplicates: str = "error", name: str | None = None) -> SensingGraph:
        """A graph from a networkx graph of robots, actions and targets.

        Parameters
        ----------
        graph : networkx.Graph
            Each node has the attribute ``kind``: ``robot``, ``action`` or ``target``. Its name is the attribute ``name``, else the node
            itself; it may have a position ``pos``. Edges join each action to its one robot, and to the targets that it sees, these
            with the attribute ``weight``, 1 by default.
        duplicates : str
            Parallel edges: ``error`` or ``sum``.
        name : str, optional
            The graph's own by default.

        Raises
        ------
        InputError
            Naming the node or edge that is wrong.
        """
        from .sensing_sources import edges_from_networkx

        return _warned(graph_of_edges(**edges_from_networkx(graph, duplicates=duplicates, name=name)))

    @classmethod
    def from_positions(
        cls, action_positions: ArrayLike, robot_of_action: ArrayLike, target_positions: ArrayLike, sensing_range: float, *,
        weight: str = "binary", closest: float = 0.01, robots: int | Iterable[str] | None = None, targets: Iterable[str] | None = None,
        action_names: Iterable[str] | None = None, name: str = "sensing-graph",
    ) -> SensingGraph:  # fmt: skip
        """A graph of what lies within a sensing range.

        Parameters
        ----------
        action_positions : array of shape (actions, 2), units of distance
            Where the robot would be.
        robot_of_action : array of shape (actions,)
            The robot of each action, from 0.
        target_positions : array of shape (targets, 2), units of distance
            Where targets are.
        sensing_range : float, units of distance, > 0
            Targets at this distance are still seen.
        weight : str
            ``binary``: 1; ``inverse-distance``: 1 / max(distance, closest).
        closest : float, units of distance, > 0
            Distances below count as this one, so that no weight exceeds 1 / closest.
        robots, targets, action_names, name
            See ``SensingGraph.from_edges``.

        Raises
        ------
        InputError
            If a position or a distance is not what it must be.
        UsageError
            For another weight.

        Notes
        -----
        Source: Sung (2019), section 3.3, with the cap that inverse distances need as the distance vanishes;
        docs/formulations/sensing.md#model.
        """
        from .sensing_sources import edges_from_positions

        edges = edges_from_positions(
            action_positions, robot_of_action, target_positions, sensing_range, weight=weight, closest=closest, robots=robots,
            targets=targets, action_names=action_names, name=name,
        )  # fmt: skip
        return _warned(graph_of_edges(**edges))

    def to_frame(self) -> pd.DataFrame:
        """One row per edge: robot, action, target, weight; see ``sensing_sources.graph_to_frame``."""
        from .sensing_sources import graph_to_frame

        return graph_to_frame(self)

    def to_networkx(self) -> Any:
        """As a ``networkx.Graph`` of robots, actions and targets; see ``sensing_sources.graph_to_networkx``."""
        from .sensing_sources import graph_to_networkx

        return graph_to_networkx(self)

    def arrange(self) -> None:
        if not self.num_robots:
            raise InputError("there is no robot", "missing")
        for key in ("indptr", "indices"):
            self.put(**{key: arrays.frozen(arrays.indices(key, getattr(self, key)))})
        self.put(weights=arrays.frozen(arrays.reals("weights", self.weights)))
        n = self.num_actions
        arrays.refuse_unused("robots", self.num_robots, n, "actions")
        arrays.refuse_unused("targets", self.num_targets, len(self.indices), "edges")
        if len(self.indptr) != n + 1:
            raise InputError(
                "there must be one start an action, and the number of edges",
                "wrong-shape",
                expected=str(n + 1),
                found=str(len(self.indptr)),
            )
        arrays.check_csr(self.indptr, self.indices, self.num_targets, "action", "target", "edges")
        if self.weights.shape != self.indices.shape:
            raise InputError(
                "there must be one weight an edge", "wrong-shape", expected=str(len(self.indices)), found=str(self.weights.shape)
            )
        if not (np.isfinite(self.weights).all() and (self.weights > 0).all()):
            raise InputError("weights must be positive and finite; an action that does not see a target has no edge to it", "out-of-range")

    def check_rest(self) -> None:
        self.put(notes=(*self.notes, *(note for note in self.findings if note not in self.notes)))

    @property
    def findings(self) -> tuple[str, ...]:
        """Warnings about idle robots and unseen targets, the first few by name."""
        notes = (_few("robot", "without an action that sees anything", self.idle_robots, self.robot_name),
                 _few("target", "that no action sees", self.unseen_targets, self.target_name))  # fmt: skip
        return tuple(note for note in notes if note)

    # -- sizes -------------------------------------------------------------------------------------------------------

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
        starts = arrays.row_starts(self.indices, self.num_targets)
        return Incidence(starts.astype(np.int32), self.action_of_edge[order], self.weights[order])

    @cached_property
    def action_of_edge(self) -> Indices:
        """The action of each edge, in the order of ``indices``."""
        return np.repeat(np.arange(self.num_actions, dtype=np.int32), np.diff(self.indptr))

    @cached_property
    def by_robot(self) -> tuple[Indices, Indices]:
        """``(indptr, actions)``: the actions of robot i are ``actions[indptr[i]:indptr[i + 1]]``, in ascending order."""
        starts = arrays.row_starts(self.robot_of_action, self.num_robots).astype(np.int32)
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

    def action_name(self, action: int) -> str:
        """The action's own name, or that of its robot and its position among the robot's actions: "3.1"."""
        return self.action_labels[action]

    @cached_property
    def action_labels(self) -> tuple[str, ...]:
        """``action_name`` of every action."""
        if self.action_names is not None:
            return self.action_names
        starts, actions = self.by_robot
        position = np.empty(self.num_actions, dtype=np.int64)
        position[actions] = np.arange(self.num_actions) - starts[self.robot_of_action[actions]]
        robots = self.robot_names or tuple(map(str, range(1, self.num_robots + 1)))
        return tuple(f"{robots[r]}.{k + 1}" for r, k in zip(self.robot_of_action.tolist(), position.tolist(), strict=True))

    def with_notes(self, *notes: str) -> SensingGraph:
        """A copy of the graph with further notes for the user."""
        return replace(self, notes=self.notes + notes)

    def facts(self) -> dict[str, Any]:
        """Sizes, degrees and what is idle or unseen, as plain JSON values.

        ``delta_r`` and ``delta_t`` are those of the cleaned graph: actions that see nothing do not count.
        """
        degree = np.diff(self.indptr)
        own = np.bincount(self.robot_of_action, minlength=self.num_robots)
        return {
            "robots": self.num_robots,
            "actions": self.num_actions,
            "actions_of_a_robot": [int(own.min()), int(own.max())],
            "seeing_actions": int((degree > 0).sum()),
            "targets": self.num_targets,
            "edges": self.num_edges,
            "phi": self.density,
            "delta_r": int(np.bincount(self.robot_of_action[degree > 0], minlength=1).max()),
            "delta_t": int(np.bincount(self.indices, minlength=1).max()),
            "weights": extent(self.weights) or None,
            "positions": self.action_positions is not None and self.target_positions is not None,
            "idle_robots": [self.robot_name(int(r)) for r in self.idle_robots],
            "unseen_targets": [self.target_name(int(t)) for t in self.unseen_targets],
        }

    def summary(self) -> Iterable[str]:
        return (*super().summary(), f"{self.num_edges} edges ({self.density:.3g} %)")

    # -- JSON ----------------------------------------------------------------------------------------------------------

    def own_notes(self) -> list[str]:
        return [note for note in self.notes if note not in self.findings]

    def write_own(self) -> dict[str, Any]:
        edges: dict[str, Any] = {"action": self.action_of_edge.tolist(), "target": self.indices.tolist()}
        return {"edges": edges if (self.weights == 1.0).all() else {**edges, "weight": json_numbers(self.weights)}}

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        edges = fields(data["edges"], "edges", EDGE_KEYS, EDGE_KEYS[:2])
        action = wholes(edges["action"], "edges.action")
        target = wholes(edges["target"], "edges.target", len(action))
        weight = reals(edges["weight"], "edges.weight", len(action)) if "weight" in edges else np.ones(len(action))
        return {"action": action, "target": target, "weight": weight}

    @classmethod
    def from_values(cls, **values: Any) -> SensingGraph:
        members = {f"{what}s": (values.pop(f"num_{what}s"), values.pop(f"{what}_names", None)) for what in ("robot", "target")}
        return graph_of_edges(**values, **{key: count if names is None else names for key, (count, names) in members.items()})


def graph_of_edges(
    robot_of_action: ArrayLike,
    action: ArrayLike,
    target: ArrayLike,
    weight: ArrayLike = 1.0,
    *,
    robots: int | Iterable[str] | None = None,
    targets: int | Iterable[str] | None = None,
    duplicates: str = "error",
    **further: Any,
) -> SensingGraph:
    """``SensingGraph.from_edges`` without its warnings, for readers and generators: the notes say the same.

    Further keywords go to ``SensingGraph`` as they are.
    """
    if duplicates not in ("error", "sum"):
        raise UsageError(f"duplicates must be error or sum, not {duplicates!r}", "unknown-name")
    hint = "numbers from 0; from_frames takes names"
    owner = arrays.whole_numbers("robot_of_action", robot_of_action, hint)
    a, t = arrays.whole_numbers("action", action, hint), arrays.whole_numbers("target", target, hint)
    if t.shape != a.shape:
        raise InputError("action and target must have one entry an edge", "wrong-shape", expected=str(len(a)), found=str(len(t)))
    values = arrays.reals("weight", weight)
    if values.ndim and values.shape != a.shape:
        raise InputError("weight must be a number, or have one entry an edge", "wrong-shape", expected=str(len(a)), found=str(values.shape))
    c = np.array(np.broadcast_to(values, a.shape))
    num_robots, robot_names = _count("robots", robots, owner, "actions")
    num_targets, target_names = _count("targets", targets, t, "edges")
    arrays.refuse_outside("the robot of action {}", owner, num_robots, "robot")
    arrays.refuse_outside("the action of edge {}", a, len(owner), "action")
    arrays.refuse_outside("the target of edge {}", t, num_targets, "target")
    arrays.refuse_negative("the weight of edge {}", c)
    key = a * np.int64(max(num_targets, 1)) + t
    if (np.diff(key) <= 0).any():
        order = np.argsort(key, kind="stable")
        key, c = key[order], c[order]
        first = np.concatenate([[True], np.diff(key) != 0])
        if not first.all():
            if duplicates == "error":
                k = int(order[int(np.argmin(first))])
                raise InputError(f'edge {k} joins action {a[k]} and target {t[k]} again; duplicates="sum" would add them up', "duplicate")
            with np.errstate(over="ignore"):
                c = np.add.reduceat(c, np.nonzero(first)[0])
            key = key[first]
            if np.isinf(c).any():
                k = int(key[int(np.argmax(c))])
                raise InputError(
                    f"the weights of action {k // num_targets} and target {k % num_targets} add up to infinity", "out-of-range"
                )
        a, t = np.divmod(key, max(num_targets, 1))
    if not c.all():
        a, t, c = a[c > 0], t[c > 0], c[c > 0]
    starts = arrays.row_starts(a, len(owner)).astype(np.int32)
    return SensingGraph(
        owner.astype(np.int32), starts, t.astype(np.int32), c, num_robots, num_targets, robot_names=robot_names, target_names=target_names,
        **further,
    )  # fmt: skip


def _warned(graph: SensingGraph) -> SensingGraph:
    for note in graph.findings:
        warnings.warn(note, stacklevel=3)
    return graph


def _count(what: str, members: Any, used: NDArray[np.int64], users: str) -> tuple[int, tuple[str, ...] | None]:
    """Number of members and their names; a number is refused before anything of its size is allocated."""
    if members is None or (isinstance(members, int | np.integer) and not isinstance(members, bool)):
        count = int(used.max(initial=-1)) + 1 if members is None else arrays.size(f"the number of {what}", members)
        arrays.refuse_unused(what, count, len(used), users)
        return count, None
    if isinstance(members, str | bytes) or not isinstance(members, Iterable):
        raise InputError(f"{what} must be a number or a list of names", found=repr(members)[:80])
    labels = tuple(str(g) for g in members)
    return len(labels), labels


def _few(thing: str, what: str, members: Indices, name_of: Any) -> str:
    if not len(members):
        return ""
    shown = ", ".join(name_of(int(m)) for m in members[:5])
    return f"{len(members)} {thing}{'s' * (len(members) > 1)} {what}: {shown}{', ...' if len(members) > 5 else ''}"
