"""Robots, tasks, and how far it is from each to each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from .. import number_arrays as arrays
from ..declared import Declared, NameOf, Names, extent
from ..document import json_numbers, matrix
from ..errors import InputError
from ..frames import columns_of, numbers_of
from ..memory import fits, readable
from ..number_arrays import Floats
from ..parts import LARGEST, Axis, Choice, Count, Numbers
from ..text import an

if TYPE_CHECKING:
    import pandas as pd


PROBLEMS = ("task-allocation", "balanced-partition")
"""Problems that such data allow; the first is the default."""

COLUMNS = ("name", "x", "y", "weight")
"""Columns of the frame of tasks; that of robots has all but the last."""

METRICS = ("euclidean", "manhattan", "chebyshev", "matrix")
"""Rules from places to distances; chebyshev counts the moves on a grid of eight neighbours."""

MOST_IN_FILES = 100_000
"""Robots or tasks of a file."""


@dataclass(frozen=True, eq=False, repr=False)
class RobotTasks(Declared):
    """Robots with starts, tasks, and distances. Rows of distances are robots, then tasks; columns are tasks, for nobody returns.

    ``of_positions``, ``of_distances``, ``from_frame`` and ``from_networkx`` make one from what a user has.

    Parameters
    ----------
    num_robots, num_tasks : int
        At least one each.
    metric : str
        One of ``METRICS``; ``matrix`` takes the distances as they are given.
    positions : array of shape (robots + tasks, 2), optional
        Needed by every metric but ``matrix``, where they serve pictures alone.
    matrix : array of shape (robots + tasks, tasks), optional
        Distances of the metric ``matrix``; not negative, from a task to itself taken for 0. They need not be symmetric.
    weights : array of shape (tasks,), optional
        What a task weighs in its part, in units of distance, of any sign; 0 by default. Paths do not know it.
    robot_names, task_names : tuple of str, optional
        None stands for "1", "2", ...
    name, format, problem, problems, notes
        See ``Instance``.

    Raises
    ------
    InputError
        If there is no robot or no task, or an array has the wrong shape or holds what it must not.

    Notes
    -----
    Source: Lagoudakis et al. (2005), Auction-based multi-robot routing, section II; docs/formulations/task-allocation.md#model.
    """

    kind = "robot-tasks"
    problem_names = PROBLEMS
    content = "robots and tasks"
    axes = (
        Axis("robot", most=MOST_IN_FILES, positions="robot_positions"),
        Axis("task", most=MOST_IN_FILES, positions="task_positions"),
    )
    keys = ("metric", "robots", "tasks", "distances")
    hashed = ("num_robots", "distances", "weights")
    num_robots: Annotated[int, Count("robot")]
    num_tasks: Annotated[int, Count("task")]
    metric: Annotated[str, Choice(*METRICS, required=True)] = "euclidean"
    positions: Floats | None = None
    matrix: Floats | None = None
    weights: Annotated[Floats | None, Numbers("task", low=-LARGEST, default=0.0, key="weight", what="weight")] = None
    robot_names: Names = None
    task_names: Names = None
    distances: Floats = field(init=False)
    robot_name, task_name = NameOf("robot"), NameOf("task")

    @classmethod
    def of_positions(cls, robots: ArrayLike, tasks: ArrayLike, metric: str = "euclidean", **further: Any) -> RobotTasks:
        """Robots and tasks at places.

        Parameters
        ----------
        robots, tasks : array-like, shapes (robots, 2) and (tasks, 2), or, on a line, (robots,) and (tasks,)
            Where they stand.
        metric, **further
            As of the class.
        """
        starts, places = _points("robot", robots), _points("task", tasks)
        return cls(len(starts), len(places), metric, np.vstack([starts, places]), **further)

    @classmethod
    def of_distances(cls, starts: ArrayLike, between: ArrayLike, **further: Any) -> RobotTasks:
        """Robots and tasks by their distances.

        Parameters
        ----------
        starts : array-like, shape (robots, tasks)
            From the robots to the tasks.
        between : array-like, shape (tasks, tasks)
            From task to task.
        **further
            As of the class.
        """
        first, second = _table("distances from the robots", starts), _table("distances between the tasks", between)
        tasks = second.shape[1]
        if second.shape[0] != tasks or first.shape[1] != tasks:
            shapes = f"{first.shape} and {second.shape}"
            raise InputError("distances must be of shapes (robots, tasks) and (tasks, tasks)", "wrong-shape", found=shapes)
        return cls(len(first), tasks, "matrix", matrix=np.vstack([first, second]), **further)

    @classmethod
    def from_frame(cls, robots: pd.DataFrame, tasks: pd.DataFrame, metric: str = "euclidean", name: str = "frame") -> RobotTasks:
        """Robots and tasks of two pandas frames with columns x, y and perhaps name, that of tasks perhaps weight too.

        Parameters
        ----------
        robots, tasks : DataFrame
            One row each.
        metric, name
            As of the class.

        Raises
        ------
        InputError
            For an unknown or missing column, and whatever ``RobotTasks`` refuses.
        """
        teams, places = columns_of("robots", robots, COLUMNS[:3], "xy"), columns_of("tasks", tasks, COLUMNS, "xy")
        further: dict[str, Any] = {}
        for key, part in (("robot_names", teams), ("task_names", places)):
            if "name" in part:
                further[key] = tuple(map(str, part["name"]))
        if "weight" in places:
            further["weights"] = numbers_of("tasks", "weight", places["weight"])
        points = [
            np.column_stack([numbers_of(what, axis, part[axis]) for axis in "xy"]) for what, part in (("robots", teams), ("tasks", places))
        ]
        return cls.of_positions(points[0], points[1], metric, name=name, format="frame", **further)

    @classmethod
    def from_networkx(cls, graph: Any, robots: Sequence[Any], tasks: Sequence[Any], *, weight: str = "weight") -> RobotTasks:
        """Robots and tasks at nodes of a graph; distances are shortest paths along its edges, directed ones one way.

        Parameters
        ----------
        graph : networkx graph
            Its nodes are places, its edges ways.
        robots, tasks : sequences of nodes
            A node may hold several; names are those of the nodes where they differ.
        weight : str
            Attribute with an edge's length; edges without it are 1 long.

        Raises
        ------
        InputError
            If a node does not exist, a length is negative or NaN, or no way leads from a robot to a task or between tasks.
        """
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import dijkstra

        nodes = {node: k for k, node in enumerate(graph)}
        for what, places in (("robot", robots), ("task", tasks)):
            for node in places:
                if node not in nodes:
                    raise InputError(f"{an(what)} stands at {node!r}, which is no node of the graph", "unknown-name")
        shortest: dict[tuple[int, int], float] = {}
        for tail, head, data in graph.edges(data=True):
            try:
                length = float(data.get(weight, 1.0))
            except (TypeError, ValueError):
                length = -1.0
            if not 0.0 <= length < np.inf:
                raise InputError(
                    f"the length of edge {tail!r} to {head!r} must be finite and not negative", "out-of-range", found=str(data.get(weight))
                )
            for pair in ((nodes[tail], nodes[head]),) if graph.is_directed() else ((nodes[tail], nodes[head]), (nodes[head], nodes[tail])):
                shortest[pair] = min(length, shortest.get(pair, np.inf))
        ends = np.array(list(shortest), dtype=np.int64).reshape(-1, 2)
        # scipy takes a stored 0 for an edge of no length only where it is stored explicitly, as it is here
        arcs = csr_matrix((np.array(list(shortest.values())), (ends[:, 0], ends[:, 1])), shape=(len(nodes),) * 2)
        rows = [nodes[node] for node in (*robots, *tasks)]
        matrix = dijkstra(arcs, indices=rows)[:, rows[len(robots) :]] if rows else np.zeros((0, 0))
        lost = np.argwhere(np.isinf(matrix))
        if len(lost):
            i, j = lost[0].tolist()
            begin = f"robot {robots[i]!r}" if i < len(robots) else f"task {tasks[i - len(robots)]!r}"
            raise InputError(f"no way leads from {begin} to task {tasks[j]!r}", "contradiction", expected="tasks that robots can reach")
        named = [tuple(map(str, places)) if len(set(map(str, places))) == len(places) else None for places in (robots, tasks)]
        return cls(
            len(robots), len(tasks), "matrix", matrix=matrix, robot_names=named[0], task_names=named[1],
            name=str(getattr(graph, "name", "") or "graph"), format="networkx",
        )  # fmt: skip

    def refuse_counts(self) -> None:
        super().refuse_counts()
        rows = sum(self.counts.values())
        if len(self.counts) == 2 and not fits(24.0 * rows * self.num_tasks):
            size = readable(8.0 * rows * self.num_tasks)
            raise InputError(
                f"distances of {self.num_robots:,} robots and {self.num_tasks:,} tasks need {size}, more than there is", "too-large"
            )

    def check_rest(self) -> None:
        self.put(positions=self._positions(), matrix=self._matrix())
        self.put(distances=self.matrix if self.matrix is not None else arrays.frozen(self._measured()))

    def _positions(self) -> Floats | None:
        points = arrays.positions("place", self.positions, self.num_robots + self.num_tasks)
        if points is None and self.metric != "matrix":
            raise InputError(f"the metric {self.metric} needs positions of all robots and tasks", "missing")
        if points is not None and (np.abs(points) > LARGEST).any():
            k = int(np.argmax((np.abs(points) > LARGEST).any(axis=1)))
            raise InputError(f"coordinates of {self.row_name(k)} must be at most {LARGEST:g}", "out-of-range", found=str(points[k]))
        return points

    def _matrix(self) -> Floats | None:
        if self.metric != "matrix":
            if self.matrix is not None:
                raise InputError(
                    f"the metric {self.metric} measures distances itself; a matrix goes with the metric 'matrix'", "contradiction"
                )
            return None
        if self.matrix is None:
            raise InputError("the metric 'matrix' needs a matrix of distances", "missing")
        table, shape = _table("distances", self.matrix).copy(), (self.num_robots + self.num_tasks, self.num_tasks)
        if table.shape != shape:
            raise InputError(
                "distances must have one row a robot and task, and one column a task", "wrong-shape", expected=str(shape),
                found=str(table.shape),
            )  # fmt: skip
        table[np.arange(self.num_robots, shape[0]), np.arange(self.num_tasks)] = 0.0
        wrong = ~((table >= 0) & (table <= LARGEST))
        if wrong.any():
            i, j = (int(v[0]) for v in np.nonzero(wrong))
            what = f"the distance from {self.row_name(i)} to task {self.task_name(j)}"
            raise InputError(f"{what} must be from 0 to {LARGEST:g}", "out-of-range", found=str(table[i, j]))
        return arrays.frozen(table)

    def _measured(self) -> Floats:
        assert self.positions is not None
        tasks = self.positions[self.num_robots :]
        dx, dy = (np.abs(self.positions[:, None, k] - tasks[None, :, k]) for k in (0, 1))
        return np.hypot(dx, dy) if self.metric == "euclidean" else dx + dy if self.metric == "manhattan" else np.maximum(dx, dy)

    # -- parts and names -----------------------------------------------------------------------------------------------

    @property
    def starts(self) -> Floats:
        """Distances from the robots to the tasks, shape (robots, tasks)."""
        return self.distances[: self.num_robots]

    @property
    def between(self) -> Floats:
        """Distances between the tasks, shape (tasks, tasks)."""
        return self.distances[self.num_robots :]

    def row_name(self, row: int) -> str:
        """The robot or task that a row of the distances stands for."""
        robots = self.num_robots
        return f"robot {self.robot_name(row)}" if row < robots else f"task {self.task_name(row - robots)}"

    @property
    def robot_positions(self) -> Floats | None:
        return None if self.positions is None else self.positions[: self.num_robots]

    @property
    def task_positions(self) -> Floats | None:
        return None if self.positions is None else self.positions[self.num_robots :]

    def facts(self) -> dict[str, Any]:
        """Counts, and the range of distances."""
        away = self.distances[self.distances > 0] if (self.distances > 0).any() else np.zeros(1)
        return {**self.sizes(), "metric": self.metric, "distances": extent(away), "weights": float(np.asarray(self.weights).sum())}

    def summary(self) -> Iterable[str]:
        return (*super().summary(), self.metric)

    def write_own(self) -> dict[str, Any]:
        return {} if self.matrix is None else {"distances": json_numbers(self.matrix)}

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        if "distances" not in data:
            return {}
        return {"matrix": matrix(data["distances"], "distances", counts["robot"] + counts["task"], counts["task"])}

    @classmethod
    def from_values(cls, **values: Any) -> RobotTasks:
        places = [values.pop(key) for key in ("robot_positions", "task_positions")]
        if (places[0] is None) != (places[1] is None):
            raise InputError("positions are given of robots or of tasks alone", "missing", expected="x and y of both, or of neither")
        return cls(**values, positions=None if places[0] is None else np.vstack(places))


def _points(what: str, places: ArrayLike | Iterable[Any]) -> Floats:
    points = _table(f"{what} positions", places, several=False)
    if points.ndim == 1:
        points = np.column_stack([points, np.zeros(len(points))])
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputError(f"{what} positions must be two numbers each, or one on a line", "wrong-shape", found=f"shape {points.shape}")
    return points


def _table(what: str, values: Any, several: bool = True) -> Floats:
    try:
        table = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} must be numbers, as many in each row", found=repr(values)[:40]) from None
    if several and table.ndim != 2:
        raise InputError(f"{what} must be a table", "wrong-shape", found=f"shape {table.shape}")
    return table
