"""Form ``errand-choice``: one binary per robot, bin and request."""

from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..joint_assignment import Errands, JointAssignment


def build(problem: JointAssignment) -> Compiled:
    """Robot i fetches bin j and serves request q on the way (y_ijq); j or q may be none, but not both::

        min  sum c_ijq y_ijq,   y binary
        robot[i]     sum_jq y_ijq <= 1
        bin[j]       sum_iq y_ijq <= 1        bins but none
        request[q]   sum_ij y_ijq <= 1        requests but none
        pickups      sum_iq sum_(j not none) y_ijq = K
        deliveries   sum_ij sum_(q not none) y_ijq = D

    An axial three-index assignment (Pierskalla 1968). Duals of bins, requests and the last two rows are evidence.
    """
    instance, n, m, q = problem.instance, problem.num_robots, problem.num_bins, problem.num_requests
    there = np.isfinite(problem.costs)
    there[:, -1, -1] = False
    i, j, k = np.nonzero(there)
    column = np.arange(len(i))
    names = [
        [instance.name_of("robot", r) for r in range(n)], [*(instance.name_of("bin", b) for b in range(m)), "none"],
        [*(instance.name_of("request", r) for r in range(q)), "none"],
    ]  # fmt: skip
    y = Variables("y", (i, j, k), tuple(names), np.zeros(len(i)), np.ones(len(i)), problem.costs[i, j, k], integer=True)
    fetch, bring = j < m, k < q
    blocks = [
        rows("robot", n, [(i, column, 1.0)], upper=1.0, keys=(np.arange(n),), labels=(names[0],)),
        rows("bin", m, [(j[fetch], column[fetch], 1.0)], upper=1.0, keys=(np.arange(m),), labels=(names[1],)),
        rows("request", q, [(k[bring], column[bring], 1.0)], upper=1.0, keys=(np.arange(q),), labels=(names[2],)),
        rows("pickups", 1, [(np.zeros(int(fetch.sum()), int), column[fetch], 1.0)], float(problem.pickups), float(problem.pickups)),
        rows("deliveries", 1, [(np.zeros(int(bring.sum()), int), column[bring], 1.0)], *(float(problem.deliveries),) * 2),
    ]

    def decode(vector: Floats) -> Errands:
        errands = [(-1, -1)] * n
        for at in np.nonzero(vector[: len(column)] > 0.5)[0].tolist():
            errands[int(i[at])] = (int(j[at]) if fetch[at] else -1, int(k[at]) if bring[at] else -1)
        return tuple(errands)

    def encode(answer: Any) -> Floats:
        errands = np.array(answer).reshape(n, 2)
        own = np.where(errands < 0, [m, q], errands)
        chosen = (own[i, 0] == j) & (own[i, 1] == k)
        if int(chosen.sum()) != int((errands >= 0).any(axis=1).sum()):
            raise InputError("the answer has an errand that is not allowed", "unsupported")
        return np.asarray(chosen, dtype=np.float64)

    def dual_evidence(row_duals: Floats) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        bins, requests, levels = duals[n : n + m], duals[n + m : n + m + q], duals[n + m + q :]
        data = {
            "bins": (-bins).tolist(), "requests": (-requests).tolist(), "pickup": float(levels[0]), "delivery": float(levels[1])
        }  # fmt: skip
        value = float(duals[: n + m + q].sum() + levels @ [problem.pickups, problem.deliveries])
        return Evidence("errand-prices", "LP duals of errand-choice", value, data)

    return Compiled(Program("errand-choice", "min", (y,), tuple(blocks)), problem, decode, encode, dual_evidence)


def _size(problem: JointAssignment) -> ProgramSize:
    errands = float(problem.costs.size)
    return ProgramSize(errands, problem.num_robots + problem.num_bins + problem.num_requests + 2.0, 5.0 * errands)


FORMS.enter(Form("errand-choice", "joint-assignment", frozenset({"triples"}), build, size=_size))
