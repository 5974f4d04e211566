r"""The strong linearisation of a selection: each item is served by at most one chosen element.

Elements e, items j, edges of weight c_ej > 0 (coverage: the weight of the item)::

    max  sum c_ej z_ej
    (constraint)    sum x_e <= k,   or  sum_{e in group} x_e <= limit,   or  sum cost_e x_e <= budget
    item[j]         sum_e z_ej <= 1
    link[e,j]       z_ej - x_e <= 0
    x_e in {0,1},   0 <= z_ej <= 1

Only x needs to be whole: for whole x the best z serves each item by its heaviest chosen element. For robots and targets
(winner takes all) z_mj credits target j to the robot of action m, and y_ij = sum_{m of i} z_mj.

Evidence ``item-prices``: the duals p_j >= 0 of the item rows. With them a link is worth max(0, c_ej - p_j), and the LP's value is
sum_j p_j plus the best choice of elements by the sums of those, which is what the checker multiplies out.

Source: Balinski (1965) for facility location; announced in Sung (2019), footnote 4;
docs/formulations/winner-takes-all.md#strong-linearisation.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Floats, Program, Variables
from ...programs.rows import rows
from ..selections import Selection
from ._selections import FEATURES, at_most, choice, chosen, constraint_rows, decisions, edges_of, edges_size, indicator, prices_evidence

if TYPE_CHECKING:
    from ...problem import Problem
    from ..submodular_selection import SubmodularSelection


def build(problem: SubmodularSelection) -> Compiled:
    """The strong linearisation; see the module's text for its mathematics."""
    edges = edges_of(problem)
    n, m, every = edges.elements, edges.size, np.arange(edges.size)
    z = Variables("z", (edges.element, edges.item), (edges.names, edges.item_names), lower=np.zeros(m), upper=np.ones(m), cost=edges.weight)
    limits = constraint_rows(problem)
    served = rows(
        "item", edges.items, [(edges.item, n + every, 1.0)], **at_most(1.0), keys=(np.arange(edges.items),), labels=(edges.item_names,)
    )
    link = rows("link", m, [(every, n + every, 1.0), (every, edges.element, -1.0)], **at_most(), keys=z.keys, labels=z.labels)

    def encode(answer: Selection) -> Floats:
        x = indicator(answer, n)
        served_by = np.zeros(m)
        served_by[edges.best(x)] = 1.0
        return np.concatenate([x, served_by])

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        prices = duals[limits.size : limits.size + edges.items]
        return prices_evidence(prices, duals[: limits.size], "item prices of the strong LP", of)

    program = Program("strong-linearisation", "max", (choice(edges), z), (limits, served, link))
    return Compiled(program, problem, lambda v: chosen(v[:n]), encode, dual_evidence, **decisions(problem))


FORMS.add(
    "strong-linearisation",
    Form("strong-linearisation", "selection", FEATURES, build, order=1, size=partial(edges_size, each=(1.0, 1.0, 1.0, 3.0))),
)
