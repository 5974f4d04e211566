r"""The facility-location form of a selection: an item is served at a level or not, whoever serves it.

Let w_j1 < ... < w_jL be the different weights of item j's edges, w_j0 = 0, and u_jl say that some chosen element gives item j at least
w_jl::

    max  sum_j sum_l (w_jl - w_j,l-1) u_jl
    (constraint)    as in the strong linearisation
    level[j,l]      u_jl - u_j,l+1 - sum_{e: c_ej = w_jl} x_e <= 0           u_j,L+1 = 0
    x_e in {0,1},   0 <= u_jl <= 1

The rows of an item add up to u_jl <= sum of x_e over all elements that give it w_jl or more, the radius formulation of Cornuéjols,
Nemhauser and Wolsey; written so, each edge stands in one row. The two have the same points, and the LP has the value of the strong
linearisation. Only x needs to be whole. Coverage, and weights that are all alike, have one row an item.

Evidence ``item-prices``: with the duals v_jl >= 0 of the level rows the bound u_jl <= 1 is worth s_jl = max(0, w_jl - w_j,l-1 - v_jl +
v_j,l-1), and p_j = sum_l s_jl. Adding up, v_jl >= w_jl - p_j, and v_jl >= 0 is what a link of that weight is worth, so the prices prove at
least the LP's value.

Source: Cornuéjols, Nemhauser, Wolsey (1980), "A canonical representation of simple plant location problems and its applications"; Elloumi
(2010), "A tighter formulation of the p-median problem", for the differences of rows;
docs/formulations/winner-takes-all.md#facility-location.
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
from ._selections import (
    FEATURES,
    Labels,
    at_most,
    choice,
    chosen,
    constraint_rows,
    decisions,
    edges_of,
    edges_size,
    indicator,
    prices_evidence,
)

if TYPE_CHECKING:
    from ...problem import Problem
    from ..submodular_selection import SubmodularSelection


def build(problem: SubmodularSelection) -> Compiled:
    """The facility-location form; see the module's text for its mathematics."""
    edges = edges_of(problem)
    n = edges.elements
    order = np.lexsort((edges.weight, edges.item))
    item, weight = edges.item[order], edges.weight[order]
    fresh = np.ones(len(order), dtype=bool)
    fresh[1:] = (item[1:] != item[:-1]) | (weight[1:] != weight[:-1])
    level = np.cumsum(fresh) - 1
    item, weight = item[fresh], weight[fresh]
    size, every = len(item), np.arange(len(item))
    lowest = np.ones(size, dtype=bool)
    lowest[1:] = item[1:] != item[:-1]
    step = weight - np.where(lowest, 0.0, np.concatenate([[0.0], weight[:-1]])[:size])
    rank = every - np.maximum.accumulate(np.where(lowest, every, 0))

    u = Variables(
        "u", (item, rank), (edges.item_names, Labels(size, lambda k: str(k + 1))), lower=np.zeros(size), upper=np.ones(size), cost=step
    )
    limits = constraint_rows(problem)
    below = np.nonzero(~lowest)[0] - 1
    parts = [(every, n + every, 1.0), (below, n + below + 1, -1.0), (level, edges.element[order], -1.0)]
    levels = rows("level", size, parts, **at_most(), keys=u.keys, labels=u.labels)

    def encode(answer: Selection) -> Floats:
        x = indicator(answer, n)
        best, served = edges.best(x), np.zeros(edges.items)
        served[edges.item[best]] = edges.weight[best]
        return np.concatenate([x, (weight <= served[item]).astype(np.float64)])

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        v = duals[limits.size :]
        v = np.maximum(v if v.sum() > 0 else -v, 0.0)
        previous = np.where(lowest, 0.0, np.concatenate([[0.0], v[:-1]])[:size])
        prices = np.bincount(item, np.maximum(step - v + previous, 0.0), minlength=edges.items)
        of_items, of_limits = np.asarray(prices, dtype=np.float64), duals[: limits.size]
        return prices_evidence(of_items, of_limits, "item prices of the facility-location LP", of)

    program = Program("facility-location", "max", (choice(edges), u), (limits, levels))
    return Compiled(program, problem, lambda v: chosen(v[:n]), encode, dual_evidence, **decisions(problem))


FORMS.add("facility-location", Form("facility-location", "selection", FEATURES, build, size=partial(edges_size, each=(1.0, 1.0, 0.0, 3.0))))
