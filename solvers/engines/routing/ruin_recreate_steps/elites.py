"""A few good answers that differ, and new ones made of two of them: routes of one, next to each other, in place of the other one's."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from .....formulations.routing.routes import Route, Routes

if TYPE_CHECKING:
    from .arrays import Arrays


class Elites:
    """The best answers of several anneals.

    Source: after the selective route exchange of Nagata and Kobayashi (2010), A memetic algorithm for the pickup and delivery problem with
    time windows using selective route exchange crossover, PPSN XI; here the routes are those near to a customer drawn at random.
    """

    def __init__(self, held: Arrays, seed: int) -> None:
        self.held, self.random = held, random.Random(seed)
        self.answers: list[tuple[int, Routes]] = []
        self.parent: int | None = None

    def add(self, value: int, answer: Routes) -> None:
        """Keep the answer of an anneal; one made of others in place of the one it comes of, or of the worst one, if it is better."""
        if self.parent is None:
            self.answers.append((value, answer))
        elif value not in (known for known, _ in self.answers):
            worst = max(range(len(self.answers)), key=lambda k: self.answers[k][0])
            place = self.parent if value < self.answers[self.parent][0] else worst
            if value < self.answers[place][0]:
                self.answers[place] = value, answer

    def make(self) -> Routes:
        """An answer made of two, as many routes at most as the first one has; sites may be on none of them."""
        self.parent, other = self.random.sample(range(len(self.answers)), 2)
        first, second = tuple(self.answers[self.parent][1]), tuple(self.answers[other][1])
        route_of = {c: k for k, one in enumerate(second) for c in one.visits}
        seed = self.random.choice(self.held.customers.tolist())
        near = dict.fromkeys(route_of[c] for c in (seed, *self.held.near[seed].tolist()) if c in route_of)
        taken = [second[k] for k in list(near)[: self.random.randint(1, max(1, len(second) // 2))]]
        stands_for = self.held.stands_for
        visited = {stands_for[c] for one in taken for c in one.visits}
        rest = [(one, Route(tuple(c for c in one.visits if stands_for[c] not in visited), one.vehicle)) for one in first]
        rest.sort(key=lambda pair: -len(pair[1].visits) / len(pair[0].visits))
        return Routes.of([*taken, *(left for _, left in rest[: max(0, len(first) - len(taken))] if left.visits)])
