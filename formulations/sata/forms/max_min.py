r"""The max-min form: the least of many sums, as one variable below all of them.

Robots i with actions m, targets j, weights c_mj >= 0 (``BottleneckSATA``)::

    max  w
    robot[i]    sum_{m of i} x_m           <= 1
    target[j]   sum_m c_mj x_m  -  w       >= 0
    x_m in {0,1}  (0 <= x_m <= 1 where robots may be divided),   w >= 0

Packing rows A and covering rows C over x >= 0 (``MaxMinLP``)::

    max  w,  packing[i]  (A x)_i <= 1,      covering[j]  (C x)_j - w >= 0        sense ``max``
    min  w,  packing[i]  (A x)_i - w <= 0,  covering[j]  (C x)_j     >= 1        sense ``min``

Evidence ``target-weights`` from the LP's duals y_j of the target rows: at most sum_i max_{m of i} sum_j c_mj y_j / sum_j y_j is
possible, with whole actions or shares. Evidence ``packing-covering-duals`` from the duals z of the packing and y of the covering rows:
with C'y <= A'z, sum z / sum y bounds the maximum from above; with sum z = 1 in place of that, the minimum is at least sum y. Interior
points leave duals that break these a little, so z is mended before it is handed on.

Source: Sung (2019), (3.1), (3.2), (3.5); Floréen et al. (2011), Local approximability of max-min and min-max linear programs;
docs/formulations/bottleneck.md#form.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.sata.max_min_lp import SparseMatrix
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...problem import Problem
from ...programs.compiled import Compiled
from ...programs.program import INTEGERS, LINEAR, Floats, Indices, Program, Rows, Variables
from ...programs.size import ProgramSize
from ...verified_bounds import proved
from ..bottleneck_sata import BottleneckSATA
from ..max_min_lp import MaxMinLP
from ..selections import Selection, indicator
from ._selections import Labels, chosen

Csr = tuple[Indices, Indices, Floats]

NEGLIGIBLE = 1e-9
"""Weights below this share of the largest one are left out of evidence: they are what an interior point leaves of zeros."""


def build(problem: BottleneckSATA | MaxMinLP) -> Compiled:
    """The max-min program; see the module's text for its mathematics."""
    from ..bottleneck_sata import BottleneckSATA

    return _of_graph(problem) if isinstance(problem, BottleneckSATA) else _of_matrices(problem)


# -- robots and targets -----------------------------------------------------------------------------------------------


def _of_graph(problem: BottleneckSATA) -> Compiled:
    g = problem.graph
    n = g.num_actions
    names = Labels(g.num_robots, g.robot_name), Labels(n, g.action_name), Labels(g.num_targets, g.target_name)
    x = Variables("x", (np.arange(n),), (names[1],), lower=np.zeros(n), upper=np.ones(n), cost=np.zeros(n), integer=not problem.fractional)
    starts, actions = g.by_robot
    robots = _rows("robot", names[0], (starts, actions, np.ones(n)), -math.inf, 1.0)
    seen = g.by_target
    targets = _rows("target", names[2], _less_w((seen.indptr, seen.indices, seen.weights), n), 0.0, math.inf)

    def encode(answer: Any) -> Floats:
        if isinstance(answer, Selection):
            shares = indicator(answer, n)
        else:
            shares = np.asarray(answer, dtype=np.float64)
        if shares.shape != (n,):
            raise InputError("the start has not one share an action", "wrong-shape", expected=f"({n},)", found=str(shares.shape))
        return np.append(shares, problem.coverage(shares).min())

    def decode(vector: Floats) -> Any:
        if not problem.fractional:
            return chosen(vector[:n])
        shares = np.maximum(vector[:n], 0.0)
        load = np.bincount(g.robot_of_action, shares, minlength=g.num_robots)
        return shares / np.maximum(load, 1.0)[g.robot_of_action]  # a solver's point may exceed a row by its tolerance

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        y = _clean(np.asarray(row_duals, dtype=np.float64)[g.num_robots :])
        used = np.nonzero(y)[0]
        data = {"targets": used.tolist(), "weights": y[used].tolist()}
        return proved(of, "target-weights", "dual weights of the max-min LP", data)

    def ray_evidence(ray: Floats) -> Evidence:
        return Evidence("target-weights", "actions that are decided", -math.inf, {"targets": [0], "weights": [1.0]})

    compiled = Compiled(Program("max-min", "max", (x, _w()), (robots, targets)), problem, decode, encode, dual_evidence)
    return compiled if problem.fractional else replace(compiled, ray_evidence=ray_evidence, at_most=problem.at_most)


# -- packing and covering rows ----------------------------------------------------------------------------------------


def _of_matrices(problem: MaxMinLP) -> Compiled:
    a, c, n = problem.packing, problem.covering, problem.num_variables
    maximise = problem.sense == "max"
    x = Variables(
        "x", (np.arange(n),), (Labels(n, problem.variable_name),), lower=np.zeros(n), upper=np.full(n, math.inf), cost=np.zeros(n)
    )
    packed, covered = (a.indptr, a.indices, a.data), (c.indptr, c.indices, c.data)
    if maximise:
        packing = _rows("packing", _numbers(a.rows), packed, -math.inf, 1.0)
        covering = _rows("covering", _numbers(c.rows), _less_w(covered, n), 0.0, math.inf)
    else:
        packing = _rows("packing", _numbers(a.rows), _less_w(packed, n), -math.inf, 0.0)
        covering = _rows("covering", _numbers(c.rows), covered, 1.0, math.inf)

    def encode(answer: Any) -> Floats:
        values = np.asarray(answer, dtype=np.float64)
        if values.shape != (n,):
            raise InputError("the start has not one number a variable", "wrong-shape", expected=f"({n},)", found=str(values.shape))
        return np.append(values, (c.scipy @ values).min() if maximise else (a.scipy @ values).max())

    def decode(vector: Floats) -> Floats:
        values = np.maximum(vector[:n], 0.0)  # a solver's point may exceed bounds and rows by its tolerance
        if maximise:
            return np.asarray(values / max(1.0, float((a.scipy @ values).max())))
        least = float((c.scipy @ values).min())
        return np.asarray(values / least) if 0.0 < least < 1.0 else values

    def dual_evidence(row_duals: Floats) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        y = _clean(duals[a.rows :])
        z = _mended(a, np.asarray(c.scipy.T @ y), np.abs(duals[: a.rows])) if maximise else _clean(duals[: a.rows])
        if not maximise:
            y = _lowered(c, np.asarray(a.scipy.T @ z), y)
        source = "duals of the max-min LP" if maximise else "duals of the min-max LP"
        return proved(problem, "packing-covering-duals", source, {"covering": y.tolist(), "packing": z.tolist()})

    program = Program("max-min", problem.sense, (x, _w()), (packing, covering))
    return Compiled(program, problem, decode, encode, dual_evidence)


def _mended(a: SparseMatrix, worth: Floats, z: Floats) -> Floats:
    """Packing prices z >= 0, moved so that ``A'z >= worth`` holds at every variable."""
    entry_row, rise = np.repeat(np.arange(a.rows), np.diff(a.indptr)), np.zeros(a.rows)
    if (np.bincount(a.indices, minlength=a.columns)[worth > 0] == 1).all():  # what each row has to pay stands fast
        np.maximum.at(rise, entry_row, worth[a.indices] / a.data)
        return rise
    lack = worth - a.scipy.T @ z
    short = np.nonzero((lack > 0)[a.indices])[0]
    if len(short) == 0:
        return z
    # The row with the largest coefficient pays for what is missing.
    order = short[np.lexsort((a.data[short], a.indices[short]))]
    at = order[np.append(a.indices[order][1:] != a.indices[order][:-1], True)]
    np.maximum.at(rise, entry_row[at], lack[a.indices[at]] / a.data[at])
    return z + rise


def _lowered(c: SparseMatrix, price: Floats, y: Floats) -> Floats:
    """Covering prices y >= 0, lowered so that ``C'y <= price`` holds at every variable."""
    entry_row = np.repeat(np.arange(c.rows), np.diff(c.indptr))
    cost = np.asarray(c.scipy.T @ y)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(cost > price, price / cost, 1.0)
    least = np.ones(c.rows)
    np.minimum.at(least, entry_row, share[c.indices])
    return y * least


# -- parts ------------------------------------------------------------------------------------------------------------


def _w() -> Variables:
    return Variables("w", lower=np.zeros(1), upper=np.full(1, math.inf), cost=np.ones(1))


def _numbers(size: int) -> Labels:
    return Labels(size, lambda k: str(k + 1))


def _rows(name: str, labels: Labels, matrix: Csr, lower: float, upper: float) -> Rows:
    """Rows with the same sides all, from the start of each row, the columns and the coefficients."""
    indptr, indices, data = matrix
    m = len(indptr) - 1
    sides = {"lower": np.full(m, lower), "upper": np.full(m, upper)}
    return Rows(name, (np.arange(m),), (labels,), indptr=indptr, indices=indices, data=data, **sides)


def _less_w(matrix: Csr, w: int) -> Csr:
    """The rows of a matrix, each less the variable in column ``w``."""
    indptr, indices, data = matrix
    m = len(indptr) - 1
    starts = indptr + np.arange(m + 1, dtype=np.int32)
    own = np.ones(len(indices) + m, dtype=bool)
    own[starts[1:] - 1] = False
    columns, values = np.full(len(own), w, dtype=np.int32), np.full(len(own), -1.0)
    columns[own], values[own] = indices, data
    return starts.astype(np.int32), columns, values


def _clean(duals: Floats) -> Floats:
    """Nonnegative weights, the negligible ones 0; solvers disagree on the sign of a dual, and all of these share one."""
    y = np.maximum(duals if duals.sum() > 0 else -duals, 0.0)
    return np.where(y > NEGLIGIBLE * y.max(initial=0.0), y, 0.0)


def _size(problem: BottleneckSATA | MaxMinLP) -> ProgramSize:
    from ..bottleneck_sata import BottleneckSATA

    if isinstance(problem, BottleneckSATA):
        g = problem.graph
        return ProgramSize(g.num_actions + 1.0, g.num_robots + float(g.num_targets), float(len(g.indices)) + g.num_actions + g.num_targets)
    a, c = problem.packing, problem.covering
    return ProgramSize(problem.num_variables + 1.0, a.rows + float(c.rows), float(len(a.indices)) + len(c.indices) + a.rows + c.rows)


def _makes(problem: BottleneckSATA | MaxMinLP) -> frozenset[str]:
    return INTEGERS if "whole-actions" in problem.features() else LINEAR


FEATURES = frozenset({"sensing", "whole-actions", "packing-covering", "min-max", "several-packing-rows"})
FORMS.enter(Form("max-min", "max-min", FEATURES, build, size=_size, makes=_makes))
