"""Which solver and heuristic takes which variant: every cell is the answer of ``wb.solvers`` and ``wb.heuristics`` for a small problem."""

from collections.abc import Callable
from typing import Any

import pandas as pd
from markdown_tables import markdown_table

import waybound as wb
from waybound.formulations.problem import Problem
from waybound.solving.listing import heuristic_table, solver_table

TEXT = """# Variants and who takes them

Made by asking. For a small problem of each variant, `wb.solvers(problem)` and `wb.heuristics(problem)` say which take it, and what each of
the others lacks. *Exact* solvers search the whole problem through [forms](../formulations/index.md#what-there-is) or by engines that
finish; engines such as `pyvrp`, `ortools` and `vroom` find good answers and prove nothing, so that the bound beside them is waybound's own.
`vrpsolver` claims optima and bounds, and shows no evidence.
What several features together mean is on the page of [routing features](../formulations/routing-features.md).

## Routing

{routing}

## Robots, selection, risk and auctions

{others}
"""

PLAIN = {"id": ["depot", "a", "b", "c"], "x": [0, 3, 4, 0], "y": [0, 0, 3, 5]}


def _routes(objective: Any = None, **given: Any) -> Callable[[], Problem]:
    """Four sites with further columns (lists of four) and arguments of ``from_frame``."""

    def make() -> Problem:
        columns = {key: value for key, value in given.items() if isinstance(value, list)}
        others = {key: value for key, value in given.items() if key not in columns}
        frame = pd.DataFrame({**PLAIN, **columns})
        return wb.RoutingProblem.from_frame(frame, objective=objective, **others)

    return make


DEMAND = [0, 2, 3, 2]

ROUTING: dict[str, Callable[[], Problem]] = {
    "one tour (TSP)": _routes(vehicles=1),
    "capacities (CVRP)": _routes(demand=DEMAND, capacity=5),
    "time windows (VRPTW)": _routes(demand=DEMAND, capacity=5, ready=[0, 2, 0, 0], due=[99, 20, 30, 40], service=[0, 1, 1, 1]),
    "several depots (MDVRP)": _routes(depot=[True, False, False, True], demand=[0, 2, 3, 0], capacity=5),
    "mixed fleet": _routes(
        demand=DEMAND, fleet=({"name": "van", "capacity": 4, "count": 2}, {"name": "truck", "capacity": 9, "fixed_cost": 3})
    ),
    "prizes and penalties": _routes(
        demand=DEMAND,
        capacity=5,
        vehicles=1,
        required=[True, False, False, False],
        penalty=[0, 9, 9, 9],
        objective=wb.TotalCost() + wb.Penalties(),
    ),
    "pickups and deliveries (PDP)": _routes(shipments=(("a", "b", 2),), capacity=5, vehicles=2),
    "deliveries and returns": _routes(demand=DEMAND, pickup=[0, 1, 1, 0], capacity=6),
    "several loads": _routes(demand=DEMAND, demand2=[0, 1, 0, 2], fleet=({"capacity": (5, 3), "count": 2},)),
    "skills": _routes(skills=["", "crane", "", ""], fleet=({"name": "a", "skills": ("crane",), "count": 1}, {"name": "b", "count": 2})),
    "several windows": _routes(windows={"a": [(0, 3), (8, 12)]}, vehicles=2),
    "alternatives (one of several sites)": _routes(groups=(("a", "b"),), required=[True, False, False, True], vehicles=2),
    "reloads on the way": _routes(demand=DEMAND, fleet=({"capacity": 4, "count": 1, "reloads": ("depot",), "max_reloads": 2},)),
    "least longest route (min-makespan)": _routes(vehicles=2, objective=wb.Objective.of(wb.Makespan())),
    "fewest vehicles, then cost": _routes(demand=DEMAND, capacity=5, objective=wb.Vehicles().then(wb.TotalCost())),
    "orienteering": _routes(
        reward=[0, 3, 4, 5], required=[True, False, False, False], vehicles=1, max_duration=12, objective=wb.Objective.of(wb.Reward())
    ),
    "energy": _routes(fleet=({"energy": {"capacity": 20, "rate": 1}, "count": 2},)),
}

OTHERS: dict[str, Callable[[], Problem]] = {
    "`bottleneck`": lambda: wb.generate("sata", robots=4, targets=6, phi=40, problem="bottleneck"),
    "`bottleneck-lp`": lambda: wb.generate("sata", robots=4, targets=6, phi=40, problem="bottleneck-lp"),
    "`winner-takes-all`": lambda: wb.generate("sata", robots=4, targets=6, phi=40, problem="winner-takes-all"),
    "`selection` (coverage)": lambda: wb.generate("coverage"),
    "`risk-allocation`": lambda: wb.generate("risk-allocation"),
    "`risky-path`": lambda: wb.generate("risky-grid"),
    "`uncertain-path`": lambda: wb.generate("prm-graph"),
    "`bin-assignment`": lambda: wb.generate("assignment", problem="bin-assignment"),
    "`bottleneck-assignment`": lambda: wb.generate("assignment", problem="bottleneck-assignment"),
    "`task-allocation`": lambda: wb.generate("robot-tasks", problem="task-allocation"),
    "`balanced-partition`": lambda: wb.generate("robot-tasks", problem="balanced-partition"),
    "`orchard-day`": lambda: wb.generate("orchard-day"),
}


def page() -> str:
    """The whole page."""
    return TEXT.format(routing=_table(ROUTING), others=_table(OTHERS))


def _table(variants: dict[str, Callable[[], Problem]]) -> str:
    rows = []
    for title, make in variants.items():
        problem = make()
        solvers = ", ".join(f"`{info.name}`" for info in solver_table(problem) if not info.missing)
        heuristics = ", ".join(f"`{info.name}`" for info in heuristic_table(problem) if not info.missing)
        forms = ", ".join(f"`{form}`" for form in problem.forms())
        rows.append((title, solvers or "none", heuristics or "none", forms or "none"))
    return markdown_table(("variant", "solvers", "heuristics", "forms, the default first"), rows)
