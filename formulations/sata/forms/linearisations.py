"""Forms of a selection: three linear ones, and the sum of products of two variables that they linearise."""

from functools import partial

import numpy as np

from ...evidence import Evidence
from ...forms import FORMS, Form
from ...problem import Problem
from ...programs.compiled import Compiled
from ...programs.program import INTEGERS, QUADRATIC, Floats, Program, Rows, Variables
from ...programs.rows import rows
from ..selections import Selection, indicator
from ..submodular_selection import SubmodularSelection
from ._selections import (
    FEATURES,
    Credits,
    Edges,
    Labels,
    at_most,
    choice,
    chosen,
    constraint_rows,
    credits_of,
    decisions,
    edges_of,
    edges_size,
    prices_evidence,
)


def facility_location(problem: SubmodularSelection) -> Compiled:
    r"""The facility-location form of a selection: an item is served at a level or not, whoever serves it.

    Let w_j1 < ... < w_jL be the different weights of item j's edges, w_j0 = 0, and u_jl say that some chosen element gives item j at least
    w_jl::

        max  sum_j sum_l (w_jl - w_j,l-1) u_jl
        (constraint)    as in the strong linearisation
        level[j,l]      u_jl - u_j,l+1 - sum_{e: c_ej = w_jl} x_e <= 0           u_j,L+1 = 0
        x_e in {0,1},   0 <= u_jl <= 1

    The rows of an item add up to u_jl <= sum of x_e over all elements that give it w_jl or more, the radius formulation of Cornuéjols,
    Nemhauser and Wolsey; written so, each edge stands in one row. The two have the same points, and the LP has the value of the strong
    linearisation. Only x needs to be whole. Coverage, and weights that are all alike, have one row per item.

    Evidence ``item-prices``: with the duals v_jl >= 0 of the level rows the bound u_jl <= 1 is worth s_jl = max(0, w_jl - w_j,l-1 - v_jl +
    v_j,l-1), and p_j = sum_l s_jl. Adding up, v_jl >= w_jl - p_j, and v_jl >= 0 is what a link of that weight is worth, so the prices prove
    at least the LP's value.

    Source: Cornuéjols, Nemhauser, Wolsey (1980), "A canonical representation of simple plant location problems and its applications";
    Elloumi (2010), "A tighter formulation of the p-median problem", for the differences of rows;
    docs/formulations/winner-takes-all.md#facility-location.
    """
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


def strong_linearisation(problem: SubmodularSelection) -> Compiled:
    r"""The strong linearisation: each item is served by at most one chosen element.

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
    edges = edges_of(problem)
    n, m, every = edges.elements, edges.size, np.arange(edges.size)
    z, limits = _served_by(edges), constraint_rows(problem)
    served = rows(
        "item", edges.items, [(edges.item, n + every, 1.0)], **at_most(1.0), keys=(np.arange(edges.items),), labels=(edges.item_names,)
    )

    def encode(answer: Selection) -> Floats:
        x, served_by = indicator(answer, n), np.zeros(m)
        served_by[edges.best(x)] = 1.0
        return np.concatenate([x, served_by])

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        prices = duals[limits.size : limits.size + edges.items]
        return prices_evidence(prices, duals[: limits.size], "item prices of the strong LP", of)

    program = Program("strong-linearisation", "max", (choice(edges), z), (limits, served, _links(edges, z, n)))
    return Compiled(program, problem, lambda v: chosen(v[:n]), encode, dual_evidence, **decisions(problem))


def weak_linearisation(problem: SubmodularSelection) -> Compiled:
    r"""The weak linearisation: the textbook's way to write a product of two binary variables.

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
    edges = edges_of(problem)
    credit = credits_of(problem, edges)
    n, m, every, pairs = edges.elements, edges.size, np.arange(edges.size), len(credit.item)
    y = Variables("y", (credit.creditor, credit.item), credit.labels, lower=np.zeros(pairs), upper=np.ones(pairs), cost=np.zeros(pairs))
    first_z, z, limits = n + pairs, _served_by(edges), constraint_rows(problem)
    credited_rows = rows(
        "credit", m, [(every, first_z + every, 1.0), (every, n + credit.of_edge, -1.0)], **at_most(), keys=z.keys, labels=z.labels
    )

    def encode(answer: Selection) -> Floats:
        x, credited, served_by = indicator(answer, n), np.zeros(pairs), np.zeros(m)
        best = edges.best(x)
        served_by[best], credited[credit.of_edge[best]] = 1.0, 1.0
        return np.concatenate([x, credited, served_by])

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        prices = duals[len(duals) - edges.items :]
        return prices_evidence(prices, duals[: limits.size], "item prices of the weak LP", of)

    blocks = limits, _links(edges, z, first_z), credited_rows, _one_creditor(edges, credit)
    program = Program("weak-linearisation", "max", (choice(edges), y, z), blocks)
    return Compiled(program, problem, lambda v: chosen(v[:n]), encode, dual_evidence, **decisions(problem))


def product(problem: SubmodularSelection) -> Compiled:
    r"""The product form: the quadratic mixed-integer program as it stands.

    With creditors i and credits y_ij as in the weak linearisation::

        max  sum_j sum_i y_ij sum_{e of i} c_ej x_e
        (constraint)    as in the strong linearisation
        item[j]         sum_i y_ij <= 1
        x_e in {0,1},   y_ij in {0,1}

    The objective is a sum of products of two binary variables: neither convex nor concave, so that it needs a solver for nonconvex
    quadratic programs, or one that counts in integers. It has no linear relaxation of its own.

    Source: Sung (2019), (3.1), (3.3), (3.4); docs/formulations/winner-takes-all.md#product.
    """
    import scipy.sparse as sp

    edges = edges_of(problem)
    credit = credits_of(problem, edges)
    n, pairs = edges.elements, len(credit.item)
    y = Variables(
        "y", (credit.creditor, credit.item), credit.labels, lower=np.zeros(pairs), upper=np.ones(pairs), cost=np.zeros(pairs), integer=True
    )
    ends = edges.element, n + credit.of_edge
    entries = np.concatenate([edges.weight, edges.weight])
    quadratic = sp.csr_matrix((entries, (np.concatenate(ends), np.concatenate(ends[::-1]))), shape=(n + pairs, n + pairs))

    def encode(answer: Selection) -> Floats:
        x, credited = indicator(answer, n), np.zeros(pairs)
        credited[credit.of_edge[edges.best(x)]] = 1.0
        return np.concatenate([x, credited])

    blocks = constraint_rows(problem), _one_creditor(edges, credit)
    program = Program("product", "max", (choice(edges), y), blocks, quadratic=quadratic)
    return Compiled(program, problem, lambda v: chosen(v[:n]), encode)


def _served_by(edges: Edges) -> Variables:
    """The variables z_ej: item j is served by element e."""
    m = edges.size
    return Variables(
        "z", (edges.element, edges.item), (edges.names, edges.item_names), lower=np.zeros(m), upper=np.ones(m), cost=edges.weight
    )


def _links(edges: Edges, z: Variables, first_z: int) -> Rows:
    """The rows ``link``: only chosen elements serve."""
    every = np.arange(edges.size)
    parts = [(every, first_z + every, 1.0), (every, edges.element, -1.0)]
    return rows("link", edges.size, parts, **at_most(), keys=z.keys, labels=z.labels)


def _one_creditor(edges: Edges, credit: Credits) -> Rows:
    """The rows ``item``: each item is credited to at most one creditor. The credits' columns follow those of the elements."""
    parts = [(credit.item, edges.elements + np.arange(len(credit.item)), 1.0)]
    return rows("item", edges.items, parts, **at_most(1.0), keys=(np.arange(edges.items),), labels=(edges.item_names,))


FORMS.enter(
    Form("facility-location", "selection", FEATURES, facility_location, size=partial(edges_size, each=(1.0, 1.0, 0.0, 3.0))),
)
FORMS.enter(
    Form("strong-linearisation", "selection", FEATURES, strong_linearisation, order=1, size=partial(edges_size, each=(1.0, 1.0, 1.0, 3.0))),
)
FORMS.enter(
    Form("weak-linearisation", "selection", FEATURES, weak_linearisation, order=2, size=partial(edges_size, each=(2.0, 2.0, 1.0, 5.0))),
)
FORMS.enter(
    Form(
        "product",
        "selection",
        FEATURES,
        product,
        makes=lambda problem: INTEGERS | QUADRATIC,
        order=3,
        size=partial(edges_size, each=(1.0, 0.0, 1.0, 3.0)),
    ),
)
