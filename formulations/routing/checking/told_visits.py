"""Customers that every answer visits, and those that none does, as far as the data show it without a search."""

import numpy as np

from ..problem import RoutingProblem
from .known_features import Flags


def told_visits(problem: RoutingProblem) -> tuple[Flags, Flags]:
    """Customers who are visited in each answer, and those who are visited in none; shape (customers,). Who is both rules out all answers.

    Where all moves of a needed set come to a customer or leave him, he is visited, and his alternatives are not.
    """
    sites, customers = problem.sites, problem.sites.customers
    surely, never = sites.required.copy(), np.zeros(len(sites), dtype=bool)
    for moves in problem.needed:
        surely |= ~sites.depot & (moves.sum(axis=0) + moves.sum(axis=1) - moves.diagonal() == moves.sum())
    for group in sites.groups:
        members = np.array(group.sites)
        surely[members] |= group.required and len(members) == 1
        visited = members[surely[members]]
        never[np.setdiff1d(members, visited[:1])] |= len(visited) > 0
    return surely[customers], never[customers]


def says_more(problem: RoutingProblem, moves: Flags, surely: Flags) -> bool:
    """Whether a needed set of moves is one move, or says more than that customers are visited who are so in each answer anyway."""
    other = ~(moves if problem.forbidden is None else moves | problem.forbidden)
    np.fill_diagonal(other, False)
    visited = problem.sites.customers[surely]
    return bool(moves.sum() == 1 or (other[:, visited].any(axis=0).all() and other[visited].any(axis=1).all()))
