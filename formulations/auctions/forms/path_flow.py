"""Form ``path-flow``: open paths of robots as arcs, and a flow along them that counts what the objective counts."""

import math
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats, Integers
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Rows, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..task_allocation import OBJECTIVES, Paths, TaskAllocation


def build(problem: TaskAllocation) -> Compiled:
    """Arcs (i, j) lead from robots and tasks i to tasks j, d_ij long; x_ij is 1 where a path uses the arc, f_ij what is to come on it::

        mini-sum   min  sum d_ij x_ij          mini-ave   min  sum d_ij f_ij / tasks          mini-max   min  z
        enter[j]   sum_i x_ij = 1                                       tasks j
        leave[i]   sum_j x_ij <= 1                                      robots and tasks i
        flow[j]    sum_i f_ij - sum_k f_jk = 1                          tasks j: f counts the tasks from j on
        link[i,j]  f_ij <= F_i x_ij,    F_i = the number of tasks, one less if i is one

    For ``mini-max`` g flows beside it: what is left of the path from i on, no more than all longest arcs into tasks together (G)::

        remaining[j]  sum_i g_ij - sum_k g_jk - sum_i d_ij x_ij = 0     tasks j
        reach[i,j]    g_ij <= G x_ij
        longest[r]    sum_j g_rj <= z                                   robots r

    g and z count in a power of two near the longest arc. Source: Gavish and Graves (1978) for the flow;
    docs/formulations/task-allocation.md#form.
    """
    arcs = _Arcs(problem)
    program = Program("path-flow", "min", tuple(arcs.variables()), tuple(arcs.constraints()))
    return Compiled(program, problem, arcs.decode, arcs.encode)


class _Arcs:
    """The arcs, the columns and rows about them, and how paths and points of the program become each other."""

    def __init__(self, problem: TaskAllocation) -> None:
        self.problem, self.longest = problem, problem.objective == "mini-max"
        self.robots, self.tasks = problem.instance.num_robots, problem.instance.num_tasks
        d = np.asarray(problem.instance.distances)
        self.tail, self.head = np.nonzero(np.arange(self.robots + self.tasks)[:, None] != self.robots + np.arange(self.tasks))
        self.inner, self.size = self.tail >= self.robots, len(self.tail)
        self.most = np.where(self.inner, self.tasks - 1.0, float(self.tasks))
        self.length = d[self.tail, self.head]
        # About the longest arc, which fits all solvers' tolerances; a power of two leaves whole numbers countable.
        self.unit = 2.0 ** (math.frexp(float(d.max()))[1] - 1) if d.any() else 1.0
        self.reach = float(d.max(axis=0).sum()) / self.unit
        self.names = [problem.instance.row_name(k) for k in range(self.robots + self.tasks)]
        self.labels = (self.names, self.names[self.robots :])

    def variables(self) -> list[Variables]:
        keys, labels, zeros, ones = (self.tail, self.head), self.labels, np.zeros(self.size), np.ones(self.size)
        used = self.length if self.problem.objective == "mini-sum" else zeros
        carried = self.length / self.tasks if self.problem.objective == "mini-ave" else zeros
        blocks = [Variables("x", keys, labels, zeros, ones, used, integer=True), Variables("f", keys, labels, zeros, self.most, carried)]
        if self.longest:
            blocks.append(Variables("g", keys, labels, zeros, self.reach * ones, zeros))
            blocks.append(Variables("z", (), (), np.zeros(1), np.full(1, self.reach), np.full(1, self.unit)))
        return blocks

    def constraints(self) -> list[Rows]:
        tail, head, inner, size, names, robots, tasks = (
            self.tail, self.head, self.inner, self.size, self.names, self.robots, self.tasks
        )  # fmt: skip
        used, nodes = np.arange(size), np.arange(robots + tasks)
        carried, rest = size + used, 2 * size + used
        of_task, of_arc = ((np.arange(tasks),), (names[robots:],)), ((tail, head), self.labels)

        def left_at_tasks(flow: Integers) -> list[tuple[Integers, Integers, float]]:
            return [(head, flow, 1.0), (tail[inner] - robots, flow[inner], -1.0)]

        blocks = [
            rows("enter", tasks, [(head, used, 1.0)], 1.0, 1.0, *of_task),
            rows("leave", robots + tasks, [(tail, used, 1.0)], -np.inf, 1.0, (nodes,), (names,)),
            rows("flow", tasks, left_at_tasks(carried), 1.0, 1.0, *of_task),
            rows("link", size, [(used, carried, 1.0), (used, used, -self.most)], -np.inf, 0.0, *of_arc),
        ]
        if self.longest:
            first, robot = ~inner, np.arange(robots)
            longest = [(tail[first], rest[first], 1.0), (robot, np.full(robots, 3 * size), -1.0)]
            blocks += [
                rows("remaining", tasks, [*left_at_tasks(rest), (head, used, -self.length / self.unit)], 0.0, 0.0, *of_task),
                rows("reach", size, [(used, rest, 1.0), (used, used, -self.reach)], -np.inf, 0.0, *of_arc),
                rows("longest", robots, longest, -np.inf, 0.0, (robot,), (names[:robots],)),
            ]
        return blocks

    def decode(self, vector: Floats) -> Paths:
        used = vector[: self.size] > 0.5
        after = {int(i): int(j) for i, j in zip(self.tail[used], self.head[used], strict=True)}
        paths = []
        for robot in range(self.robots):
            at = robot
            path: list[int] = []
            while at in after and len(path) <= self.tasks:
                path.append(after[at])
                at = self.robots + path[-1]
            paths.append(tuple(path))
        return tuple(paths)

    def encode(self, answer: Any) -> Floats:
        judged = self.problem.evaluate(answer)
        if not judged.feasible:
            raise InputError(judged.violations[0].message, "unsupported")
        size = self.size
        place = {(int(i), int(j)): k for k, (i, j) in enumerate(zip(self.tail, self.head, strict=True))}
        vector = np.zeros(3 * size + 1 if self.longest else 2 * size)
        for robot, path in enumerate(answer):
            at, legs = robot, self.problem.legs(robot, path)
            for k, task in enumerate(path):
                arc = place[at, task]
                vector[arc], vector[size + arc] = 1.0, len(path) - k
                if self.longest:
                    vector[2 * size + arc] = math.fsum(legs[k:]) / self.unit
                at = self.robots + task
        if self.longest:
            vector[3 * size] = judged.values[0] / self.unit
        return vector


def _size(problem: TaskAllocation) -> ProgramSize:
    arcs, longest = float(problem.instance.distances.size), problem.objective == "mini-max"
    nodes = float(problem.instance.num_robots + 2 * problem.instance.num_tasks)
    return ProgramSize((2.0 + longest) * arcs + 1.0, (1.0 + longest) * arcs + 3.0 * nodes, (6.0 + 6.0 * longest) * arcs + nodes)


FORMS.enter(Form("path-flow", "task-allocation", frozenset(f"objective:{objective}" for objective in OBJECTIVES), build, size=_size))
