r"""The weak linearisation of a selection: the textbook's way to write a product of two binary variables.

A creditor i is a set of elements of which at most one is chosen: a robot with its actions, a group whose limit is 1, else a single
element. y_ij credits item j to creditor i, and z_ej stands for the product x_e y_ij of an element e of i::

    max  sum c_ej z_ej
    (constraint)    as in the strong linearisation
    link[e,j]       z_ej - x_e <= 0
    credit[e,j]     z_ej - y_ij <= 0                 e of i
    item[j]         sum_i y_ij <= 1
    x_e in {0,1},   0 <= z_ej <= 1,   0 <= y_ij <= 1

z_ej >= x_e + y_ij - 1 is left out: weights are positive and z is maximised. Only x needs to be whole. The LP may credit one item to
several actions of a robot in full, which makes its bound much weaker than the strong one (45.83 against 31 in case S3 of
docs/formulations/sensing.md#reference-cases); where each creditor is a single element the two are equal.

Evidence ``item-prices``: the duals p_j of the item rows. The dual splits p_j among the credit rows of a creditor, r_ej <= p_j, and
a link is worth max(0, c_ej - r_ej) >= max(0, c_ej - p_j): the prices prove at least the LP's value, often more.

Source: McCormick (1976); Sung (2019), footnote 4; docs/formulations/winner-takes-all.md#weak-linearisation.
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
    at_most,
    choice,
    chosen,
    constraint_rows,
    credits_of,
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
    """The weak linearisation; see the module's text for its mathematics."""
    edges = edges_of(problem)
    credit = credits_of(problem, edges)
    n, m, every, pairs = edges.elements, edges.size, np.arange(edges.size), len(credit.item)
    y = Variables("y", (credit.creditor, credit.item), credit.labels, lower=np.zeros(pairs), upper=np.ones(pairs), cost=np.zeros(pairs))
    z = Variables("z", (edges.element, edges.item), (edges.names, edges.item_names), lower=np.zeros(m), upper=np.ones(m), cost=edges.weight)
    first_z = n + pairs
    limits = constraint_rows(problem)
    link = rows("link", m, [(every, first_z + every, 1.0), (every, edges.element, -1.0)], **at_most(), keys=z.keys, labels=z.labels)
    given = rows("credit", m, [(every, first_z + every, 1.0), (every, n + credit.of_edge, -1.0)], **at_most(), keys=z.keys, labels=z.labels)
    served = rows(
        "item", edges.items, [(credit.item, n + np.arange(pairs), 1.0)], **at_most(1.0), keys=(np.arange(edges.items),),
        labels=(edges.item_names,),
    )  # fmt: skip

    def encode(answer: Selection) -> Floats:
        x, credited, served_by = indicator(answer, n), np.zeros(pairs), np.zeros(m)
        best = edges.best(x)
        served_by[best], credited[credit.of_edge[best]] = 1.0, 1.0
        return np.concatenate([x, credited, served_by])

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        prices = duals[len(duals) - edges.items :]
        return prices_evidence(prices, duals[: limits.size], "item prices of the weak LP", of)

    program = Program("weak-linearisation", "max", (choice(edges), y, z), (limits, link, given, served))
    return Compiled(program, problem, lambda v: chosen(v[:n]), encode, dual_evidence, **decisions(problem))


FORMS.add(
    "weak-linearisation",
    Form("weak-linearisation", "selection", FEATURES, build, order=2, size=partial(edges_size, each=(2.0, 2.0, 1.0, 5.0))),
)
