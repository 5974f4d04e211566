"""Which of the routes that were met go together best: set partitioning over them, with the risk of the team as one row.

How the risk is split is decided by the routes that are chosen, and so at least cost over the routes at hand.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....formulations.evaluation import Checklist
from ....formulations.forms import FORMS
from ....formulations.routing.forms.set_partitioning import over
from ....formulations.routing.judge import check_route
from ....formulations.routing.overrun import route_overrun
from ....formulations.routing.routes import Route, Routes
from ....instances.errors import WayboundError
from ....solvers.backend import Control, Options
from ....solvers.backends.highs import Highs

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem
    from ....formulations.stop import Stop

MOST_ROUTES = 4_000
"""That are kept, the latest ones."""

NODES = 2_000
"""Of a search for the best choice."""

SECONDS = 5.0
"""For one, at most."""


class Pool:
    """Routes that keep all limits of single routes."""

    def __init__(self, problem: RoutingProblem) -> None:
        self.problem = problem
        self.routes: dict[Route, None] = {}
        self._chosen = 0
        many = [name for name in FORMS["set-partitioning"].missing(problem) if not name.startswith("more than")]
        self.able = not many
        if self.able:
            self.add(Routes(tuple(Route((site,), kind) for kind in range(len(problem.fleet)) for site in problem.customers.tolist())))

    def add(self, answer: Routes) -> None:
        """Keep those of its routes that are good by themselves."""
        if not self.able:
            return
        for route in answer:
            if route.visits and route not in self.routes and self._good(route):
                self.routes[route] = None
                if len(self.routes) > MOST_ROUTES:
                    self.routes.pop(next(iter(self.routes)))

    def _good(self, route: Route) -> bool:
        problem, judge = self.problem, Checklist()
        plan = check_route(problem, "route", route, judge)
        risk = problem.team_risk
        return not judge.violations and (risk is None or route_overrun(problem.fleet[route.vehicle], plan) <= risk)

    def best(self, stop: Stop, seed: int, start: Routes | None) -> Routes | None:
        """The best choice that was found; None where there are no routes but those of the last time."""
        if not self.able or len(self.routes) == self._chosen or stop.reached():
            return None
        self._chosen = len(self.routes)
        control = Control()
        try:
            made = over(self.problem, self.routes)
            first = None if start is None or made.encode is None else made.encode(start)
        except WayboundError:  # a route that the form's own arithmetic finds to be beyond a limit
            return None
        options = Options(time_limit=min(SECONDS, stop.seconds_left), iterations=NODES, seed=seed, start=first)
        with stop.telling(control.stop):
            found = Highs().run(made.program, options, control).answer
        return None if found is None else made.decode(found)
