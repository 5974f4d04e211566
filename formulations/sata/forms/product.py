r"""The product form of a selection: the quadratic mixed-integer program as it stands.

A creditor i is a set of elements of which at most one is chosen: a robot with its actions, a group whose limit is 1, else a single
element. y_ij credits item j to creditor i::

    max  sum_j sum_i y_ij sum_{e of i} c_ej x_e
    (constraint)    as in the strong linearisation
    item[j]         sum_i y_ij <= 1
    x_e in {0,1},   y_ij in {0,1}

The objective is a sum of products of two binary variables: neither convex nor concave, so that it needs a solver for nonconvex
quadratic programs, or one that counts in integers. It has no linear relaxation of its own.

Source: Sung (2019), (3.1), (3.3), (3.4); docs/formulations/winner-takes-all.md#product.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import INTEGERS, QUADRATIC, Floats, Program, Variables
from ...programs.rows import rows
from ..selections import Selection
from ._selections import FEATURES, at_most, choice, chosen, constraint_rows, credits_of, edges_of, edges_size, indicator

if TYPE_CHECKING:
    from ..submodular_selection import SubmodularSelection


def build(problem: SubmodularSelection) -> Compiled:
    """The quadratic mixed-integer program; see the module's text for its mathematics."""
    import scipy.sparse as sp

    edges = edges_of(problem)
    credit = credits_of(problem, edges)
    n, pairs = edges.elements, len(credit.item)
    y = Variables(
        "y", (credit.creditor, credit.item), credit.labels, lower=np.zeros(pairs), upper=np.ones(pairs), cost=np.zeros(pairs), integer=True
    )
    served = rows(
        "item", edges.items, [(credit.item, n + np.arange(pairs), 1.0)], **at_most(1.0), keys=(np.arange(edges.items),),
        labels=(edges.item_names,),
    )  # fmt: skip
    ends = edges.element, n + credit.of_edge
    entries = np.concatenate([edges.weight, edges.weight])
    quadratic = sp.csr_matrix((entries, (np.concatenate(ends), np.concatenate(ends[::-1]))), shape=(n + pairs, n + pairs))

    def encode(answer: Selection) -> Floats:
        x, credited = indicator(answer, n), np.zeros(pairs)
        credited[credit.of_edge[edges.best(x)]] = 1.0
        return np.concatenate([x, credited])

    program = Program("product", "max", (choice(edges), y), (constraint_rows(problem), served), quadratic=quadratic)
    return Compiled(program, problem, lambda v: chosen(v[:n]), encode)


FORMS.add(
    "product",
    Form(
        "product",
        "selection",
        FEATURES,
        build,
        makes=lambda problem: INTEGERS | QUADRATIC,
        order=3,
        size=partial(edges_size, each=(1.0, 0.0, 1.0, 3.0)),
    ),
)
