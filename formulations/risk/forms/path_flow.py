r"""The flow form of a path of the least mean: one unit goes from the start to the goal.

For a risk of 1/2, where the value is the mean (``UncertainPath``)::

    min  sum_e mean_e x_e,   x_e in {0,1}
    balance[v]   sum_{e from v} x_e  -  sum_{e to v} x_e  =  [v = start] - [v = goal]
    leave[v]     sum_{e from v} x_e  <=  1

The matrix is totally unimodular, so its linear relaxation has whole optima. Circles of mean 0 beside the path are left out. Evidence
``path-potentials`` from the duals of the balance rows: their negatives are potentials.

Source: Dantzig (1963), Linear Programming and Extensions; docs/formulations/uncertain-path.md#flow-form.
"""

from __future__ import annotations

import numpy as np

from ....instances.errors import InputError
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Floats, Program, Variables
from ...programs.rows import rows
from ...routing.forms._routes import INTEGRALITY
from ..uncertain_path import Path, UncertainPath


def build(problem: UncertainPath) -> Compiled:
    """See the module's text for its mathematics."""
    g = problem.graph
    n, m, every = g.num_vertices, g.num_edges, np.arange(g.num_edges)
    names = [g.vertex_name(v) for v in range(n)]
    x = Variables("x", (g.tails, g.heads), (names, names), np.zeros(m), np.ones(m), g.mean, integer=True)
    supply = np.zeros(n)
    supply[[g.start, g.goal]] = 1.0, -1.0
    vertices = np.arange(n)
    balance = rows("balance", n, [(g.tails, every, 1.0), (g.heads, every, -1.0)], supply, supply, (vertices,), (names,))
    leave = rows("leave", n, [(g.tails, every, 1.0)], upper=1.0, keys=(vertices,), labels=(names,))

    def decode(vector: Floats) -> Path:
        whole = np.round(vector)
        if not (np.abs(vector - whole) <= INTEGRALITY).all():
            raise InputError("the point is fractional, so it is no path")
        used = np.nonzero(whole == 1)[0]
        following = dict(zip(g.tails[used].tolist(), g.heads[used].tolist(), strict=True))
        path = [g.start]
        while path[-1] != g.goal and len(path) <= n:
            if path[-1] not in following:
                raise InputError(f"the flow ends at {names[path[-1]]}")
            path.append(following[path[-1]])
        return tuple(path)

    def encode(answer: Path) -> Floats:
        edges = g.edges_of(answer)
        if (edges < 0).any():
            raise InputError("the start uses an edge that does not exist")
        return np.bincount(edges, minlength=m).astype(np.float64)

    def dual_evidence(duals: Floats) -> Evidence:
        potentials = -np.asarray(duals, dtype=np.float64)[:n]
        value = float(potentials[g.goal] - potentials[g.start])
        data = {"weights": [[1.0, 0.0]], "potentials": [potentials.tolist()]}
        return Evidence("path-potentials", "duals of the flow form", value, data)

    return Compiled(Program("path-flow", "min", (x,), (balance, leave)), problem, decode, encode, dual_evidence)


FORMS.add("path-flow", Form("path-flow", "uncertain-path", frozenset({"normal-costs"}), build))
