"""Form ``path-flow``: open paths of robots as arcs, and a flow along them that counts what the objective counts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..task_allocation import OBJECTIVES, Paths, TaskAllocation

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


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
    instance, longest = problem.instance, problem.objective == "mini-max"
    robots, tasks, d = instance.num_robots, instance.num_tasks, np.asarray(instance.distances)
    tail, head = np.nonzero(np.arange(robots + tasks)[:, None] != robots + np.arange(tasks))
    length = d[tail, head]
    # About the longest arc, which fits all solvers' tolerances; a power of two leaves whole numbers countable.
    unit = 2.0 ** (math.frexp(float(d.max()))[1] - 1) if d.any() else 1.0
    arcs, every, ones = np.arange(len(tail)), np.arange(tasks), np.ones(len(tail))
    names = [instance.row_name(k) for k in range(robots + tasks)]
    labels = (names, names[robots:])
    inner = tail >= robots
    most = np.where(inner, tasks - 1.0, float(tasks))
    cost = {"mini-sum": (length, 0.0 * length), "mini-ave": (0.0 * length, length / tasks), "mini-max": (0.0 * length,) * 2}[
        problem.objective
    ]
    size = len(arcs)
    variables = [
        Variables("x", (tail, head), labels, 0.0 * ones, ones, cost[0], integer=True),
        Variables("f", (tail, head), labels, 0.0 * ones, most, cost[1]),
    ]
    blocks = [
        rows("enter", tasks, [(head, arcs, 1.0)], 1.0, 1.0, (every,), (names[robots:],)),
        rows("leave", robots + tasks, [(tail, arcs, 1.0)], upper=1.0, keys=(np.arange(robots + tasks),), labels=(names,)),
        rows(
            "flow",
            tasks,
            [(head, size + arcs, 1.0), (tail[inner] - robots, size + arcs[inner], -1.0)],
            1.0,
            1.0,
            (every,),
            (names[robots:],),
        ),
        rows("link", size, [(arcs, size + arcs, 1.0), (arcs, arcs, -most)], upper=0.0, keys=(tail, head), labels=labels),
    ]
    far = float(d.max(axis=0).sum())
    scaled = length / unit
    if longest:
        reach = far / unit
        variables += [
            Variables("g", (tail, head), labels, 0.0 * ones, reach * ones, 0.0 * ones),
            Variables("z", (), (), np.zeros(1), np.full(1, reach), np.full(1, unit)),
        ]
        rest, z = 2 * size + arcs, np.full(robots, 3 * size)
        here = ~inner
        blocks += [
            rows(
                "remaining", tasks, [(head, rest, 1.0), (tail[inner] - robots, rest[inner], -1.0), (head, arcs, -scaled)], 0.0, 0.0,
                (every,), (names[robots:],),
            ),
            rows("reach", size, [(arcs, rest, 1.0), (arcs, arcs, -reach)], upper=0.0, keys=(tail, head), labels=labels),
            rows(
                "longest", robots, [(tail[here], rest[here], 1.0), (np.arange(robots), z, -1.0)], upper=0.0, keys=(np.arange(robots),),
                labels=(names[:robots],),
            ),
        ]  # fmt: skip

    def decode(vector: Floats) -> Paths:
        used = vector[:size] > 0.5
        after = {int(i): int(j) for i, j in zip(tail[used], head[used], strict=True)}
        paths = []
        for robot in range(robots):
            at = robot
            path: list[int] = []
            while at in after and len(path) <= tasks:
                path.append(after[at])
                at = robots + path[-1]
            paths.append(tuple(path))
        return tuple(paths)

    def encode(answer: Any) -> Floats:
        judged = problem.evaluate(answer)
        if not judged.feasible:
            raise InputError(judged.violations[0].message)
        place = {(int(i), int(j)): k for k, (i, j) in enumerate(zip(tail, head, strict=True))}
        vector = np.zeros(sum(block.size for block in variables))
        for robot, path in enumerate(answer):
            at, legs = robot, problem.legs(robot, path)
            for k, task in enumerate(path):
                arc = place[at, task]
                vector[arc], vector[size + arc] = 1.0, len(path) - k
                if longest:
                    vector[2 * size + arc] = math.fsum(legs[k:]) / unit
                at = robots + task
        if longest:
            vector[3 * size] = judged.values[0] / unit
        return vector

    return Compiled(Program("path-flow", "min", tuple(variables), tuple(blocks)), problem, decode, encode)


def _size(problem: TaskAllocation) -> ProgramSize:
    arcs, longest = float(problem.instance.distances.size), problem.objective == "mini-max"
    nodes = float(problem.instance.num_robots + 2 * problem.instance.num_tasks)
    return ProgramSize((2.0 + longest) * arcs + 1.0, (1.0 + longest) * arcs + 3.0 * nodes, (6.0 + 6.0 * longest) * arcs + nodes)


FORMS.add(
    "path-flow", Form("path-flow", "task-allocation", frozenset(f"objective:{objective}" for objective in OBJECTIVES), build, size=_size)
)
