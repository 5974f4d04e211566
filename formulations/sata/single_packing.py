"""Max-min LPs in which every variable has one packing row: scaling the columns makes them bottleneck problems of robots."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...instances.errors import UnsupportedError
from ...instances.sata.sensing_graph import SensingGraph
from ..evidence import Evidence
from .max_min_lp import MaxMinLP

Floats = NDArray[np.float64]


def as_sensing(problem: MaxMinLP) -> tuple[SensingGraph, Floats]:
    """Packing rows as robots, variables as actions, covering rows as targets.

    With ``x'_v = a_v x_v``, where a_v is the coefficient of v in its packing row, rows read ``sum x' <= 1`` and the weight of v for
    a target is ``c_v / a_v``: values are the same.

    Parameters
    ----------
    problem : MaxMinLP
        Of sense ``max``.

    Returns
    -------
    graph : SensingGraph
        One action a variable, in the order of variables. Those that cover nothing see no target, whichever packing rows they have.
    scale : array of shape (variables,)
        ``x = x' / scale``; infinite for variables that cover nothing, which makes them 0.

    Raises
    ------
    UnsupportedError
        If a variable that covers stands in several packing rows, the sense is ``min``, or a quotient overflows or vanishes.

    Notes
    -----
    Source: Sung (2019), section 3.4.1 and (3.5); docs/formulations/bottleneck.md#one-packing-row-a-variable.
    """
    missing = problem.features() & {"min-max", "several-packing-rows"}
    if missing:
        raise UnsupportedError("the reduction to robots", missing)
    a, c = problem.packing, problem.covering
    n = problem.num_variables
    covering = np.zeros(n, dtype=bool)
    covering[c.indices] = True
    robot, scale = np.zeros(n, dtype=np.int32), np.full(n, np.inf)
    rows = np.repeat(np.arange(a.rows, dtype=np.int32), np.diff(a.indptr))
    robot[a.indices] = rows
    single = covering[a.indices]
    scale[a.indices[single]] = a.data[single]
    order = np.argsort(c.indices, kind="stable")  # rows ascend within a column, as they do in the matrix
    indptr = np.zeros(n + 1, dtype=np.int32)
    np.cumsum(np.bincount(c.indices, minlength=n), out=indptr[1:])
    targets = np.repeat(np.arange(c.rows, dtype=np.int32), np.diff(c.indptr))[order]
    with np.errstate(over="ignore", under="ignore"):
        weights = (c.data / scale[c.indices])[order]
    if not (np.isfinite(weights) & (weights > 0)).all():
        raise UnsupportedError("the reduction to robots", {"coefficients whose quotients no double holds"})
    return SensingGraph(robot, indptr, targets, weights, a.rows, c.rows, name=problem.name), scale


def as_row_prices(graph: SensingGraph, evidence: Evidence) -> Evidence:
    """Evidence ``target-weights`` for the graph of ``as_sensing`` as evidence ``packing-covering-duals`` for its program.

    Weights y of the targets price the packing rows: a robot is worth its best action's weighted sum.
    """
    y = np.zeros(graph.num_targets)
    y[np.asarray(evidence.data["targets"], dtype=np.int64)] = evidence.data["weights"]
    worth = np.bincount(graph.action_of_edge, graph.weights * y[graph.indices], minlength=graph.num_actions)
    z = np.zeros(graph.num_robots)
    np.maximum.at(z, graph.robot_of_action, worth)
    return Evidence("packing-covering-duals", evidence.source, evidence.value, {"covering": y.tolist(), "packing": z.tolist()})
