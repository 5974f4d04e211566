"""Form ``largest-cost``: one binary a pair, and a variable above the cost of each robot's pair."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..bin_assignment import BinAssignment
from ._pairs import decoded, encoded, labels, pair_rows, pair_variables, pairs_size

Floats = NDArray[np.float64]


def build(problem: BinAssignment) -> Compiled:
    """Robot i is sent to bin j (x_ij), K pairs in all; l is the least of all costs, t by how much the largest is more::

    min  l + t,   x binary,   t >= 0
    cost[i]    sum_j (c_ij - l) x_ij <= t
    robot[i], bin[j], pairs as in ``bipartite``
    """
    n, size = problem.num_robots, len(problem.bins)
    low = float(problem.cost.min(initial=np.inf)) if size else 0.0
    above, column = problem.cost - low, np.arange(size)
    most = float(above.max(initial=0.0))
    t = Variables("t", (), (), np.zeros(1), np.full(1, most), np.ones(1))
    parts = [(problem.robots, column, above), (np.arange(n), np.full(n, size), -1.0)]
    capped = rows("cost", n, parts, upper=0.0, keys=(np.arange(n),), labels=(labels(problem)[0],))  # type: ignore[arg-type]

    def encode(answer: Any) -> Floats:
        x = encoded(problem, answer)
        return np.append(x, (above * x).max(initial=0.0))

    offset = low if problem.pairs else 0.0
    program = Program("largest-cost", "min", (pair_variables(problem, np.zeros(size)), t), (capped, *pair_rows(problem)), offset)
    return Compiled(program, problem, lambda v: decoded(problem, v), encode)


FORMS.add(
    "largest-cost",
    Form(
        "largest-cost",
        "bin-assignment",
        frozenset({"objective:bottleneck"}),
        build,
        size=lambda problem: pairs_size(problem) + ProgramSize(1.0, problem.num_robots, problem.num_robots + float(len(problem.bins))),
    ),
)
