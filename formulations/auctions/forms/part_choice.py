"""Form ``part-choice``: which task is in which part, and which pairs are together."""

import math
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..balanced_partition import OBJECTIVES, BalancedPartition, Parts


def build(problem: BalancedPartition) -> Compiled:
    """Task v is in part k where y_vk is 1, and the pair a, b of distance d_ab > 0 where z_abk is::

        min-max         min  t                  min-difference   min  t - s
        share[v]        sum_k y_vk = 1                                      tasks v
        most[k]         sum_v w_v y_vk + sum_ab d_ab z_abk <= t             parts k
        pair[a,b,k]     y_ak + y_bk - z_abk <= 1
        least[k]        sum_v w_v y_vk + sum_ab d_ab z_abk >= s             min-difference alone, as are
        first[a,b,k]    z_abk <= y_ak,    second[a,b,k]  z_abk <= y_bk

    Then z is whole by itself, and declared so for solvers that count. t and s count in a power of two near the largest weight or
    distance. Source: Zhang (2015), (4.3) and (4.4), as a program; docs/formulations/balanced-partition.md#form.
    """
    instance, spread = problem.instance, problem.objective == "min-difference"
    parts, tasks, weights = instance.num_robots, instance.num_tasks, problem.weights
    between = np.asarray(instance.between)
    a, b = np.nonzero(np.triu(between, 1) > 0) if problem.edges == "clique" else (np.zeros(0, np.int64),) * 2
    pairs, distance = len(a), between[a, b]
    most = max(float(np.abs(weights).max()), float(distance.max(initial=0.0)))
    unit = 2.0 ** (math.frexp(most)[1] - 1) if most > 0.0 else 1.0  # fits all solvers' tolerances, and leaves whole numbers countable
    v, k = (index.ravel() for index in np.divmod(np.arange(tasks * parts), parts))
    pair, part = np.divmod(np.arange(pairs * parts), parts)
    robots = [instance.robot_name(r) for r in range(parts)]
    names = [instance.task_name(t) for t in range(tasks)]
    y, z = tasks * parts, tasks * parts + pairs * parts
    low = float(np.minimum(weights, 0.0).sum()) / unit
    high = (float(np.maximum(weights, 0.0).sum()) + float(distance.sum())) / unit
    labels = (names, names, robots)
    variables = [
        Variables("y", (v, k), (names, robots), np.zeros(y), np.ones(y), np.zeros(y), integer=True),
        Variables("z", (a[pair], b[pair], part), labels, np.zeros(len(pair)), np.ones(len(pair)), np.zeros(len(pair)), integer=spread),
        Variables("t", (), (), np.full(1, low), np.full(1, high), np.full(1, unit)),
    ]
    chosen, together, every = np.arange(y), y + np.arange(len(pair)), np.arange(len(pair))
    first, second = a[pair] * parts + part, b[pair] * parts + part
    load = [(k, chosen, weights[v] / unit), (part, together, distance[pair] / unit)]
    keys = (a[pair], b[pair], part)
    one, place = np.arange(parts), np.full(parts, z)
    blocks = [
        rows("share", tasks, [(v, chosen, 1.0)], 1.0, 1.0, (np.arange(tasks),), (names,)),
        rows("most", parts, [*load, (one, place, -1.0)], upper=0.0, keys=(one,), labels=(robots,)),
        rows("pair", len(pair), [(every, first, 1.0), (every, second, 1.0), (every, together, -1.0)], upper=1.0, keys=keys, labels=labels),
    ]
    if spread:
        variables.append(Variables("s", (), (), np.full(1, low), np.full(1, high), np.full(1, -unit)))
        blocks += [
            rows("least", parts, [*load, (one, place + 1, -1.0)], lower=0.0, keys=(one,), labels=(robots,)),
            rows("first", len(pair), [(every, together, 1.0), (every, first, -1.0)], upper=0.0, keys=keys, labels=labels),
            rows("second", len(pair), [(every, together, 1.0), (every, second, -1.0)], upper=0.0, keys=keys, labels=labels),
        ]

    def decode(vector: Floats) -> Parts:
        own = vector[:y].reshape(tasks, parts).argmax(axis=1)
        return tuple(tuple(np.nonzero(own == r)[0].tolist()) for r in range(parts))

    def encode(answer: Any) -> Floats:
        judged = problem.evaluate(answer)
        if not judged.feasible:
            raise InputError(judged.violations[0].message, "unsupported")
        vector, own = np.zeros(z + 1 + spread), np.zeros(tasks, dtype=np.int64)
        for robot, members in enumerate(answer):
            own[list(members)] = robot
        vector[np.arange(tasks) * parts + own] = 1.0
        vector[y:z] = (own[a[pair]] == part) & (own[b[pair]] == part)
        costs = problem.costs(answer)
        vector[z] = max(costs) / unit
        if spread:
            vector[z + 1] = min(costs) / unit
        return vector

    return Compiled(Program("part-choice", "min", tuple(variables), tuple(blocks)), problem, decode, encode)


def _size(problem: BalancedPartition) -> ProgramSize:
    tasks, parts, spread = float(problem.num_tasks), float(problem.num_robots), problem.objective == "min-difference"
    pairs = tasks * (tasks - 1.0) / 2.0 if problem.edges == "clique" else 0.0
    columns = parts * (tasks + pairs)
    return ProgramSize(
        columns + 2.0, tasks + parts * (1.0 + spread) + parts * pairs * (1.0 + 2.0 * spread),
        parts * (2.0 + spread) * (tasks + 1.0) + parts * pairs * (4.0 + 5.0 * spread),
    )  # fmt: skip


FORMS.enter(
    Form(
        "part-choice", "balanced-partition",
        frozenset({*(f"objective:{objective}" for objective in OBJECTIVES), "edges:none", "edges:clique"}), build, size=_size,
    ),
)  # fmt: skip
