"""Root bounds of every exact routing form on small reference instances: ``python -m waybound.reports.benchmarks.routing_roots``.

A row per instance: the value of each form's linear relaxation, with the preparation and the fleet row that all of them share, then the
integer optimum. A dash stands for a form that cannot take the problem; forms without a linear relaxation have no column.
"""

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np

import waybound as wb
from waybound.extending import FORMS, INTEGERS

from ...formulations.routing.objective import Composable, Makespan, TotalCost
from ...instances.routing.travel import EXPLICIT, Travel
from ._harness import Option, command, markdown_row

SQUARE_4 = [(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)]
GAP_5 = [(5, 5), (0, 7), (1, 6), (2, 10), (0, 2), (1, 8)]
OCTO_8 = [(0, 0), (2, 7), (5, 3), (8, 8), (-4, 6), (-7, 1), (-3, -5), (4, -6), (9, -2)]
ASYM_5 = [[0, 4, 7, 3, 6, 5], [5, 0, 2, 6, 4, 8], [6, 3, 0, 5, 2, 7], [3, 5, 4, 0, 7, 2], [7, 4, 3, 6, 0, 3], [4, 9, 6, 2, 3, 0]]

CASES: dict[str, tuple[Travel, int, float, Composable]] = {
    "SQUARE-4, 2, 12": (Travel("euclidean", np.array(SQUARE_4, dtype=float)), 2, 12.0, TotalCost()),
    "SQUARE-4, 2, 14": (Travel("euclidean", np.array(SQUARE_4, dtype=float)), 2, 14.0, TotalCost()),
    "SQUARE-4, 4, 10": (Travel("euclidean", np.array(SQUARE_4, dtype=float)), 4, 10.0, TotalCost()),
    "GAP-5, 2, 26": (Travel("manhattan", np.array(GAP_5, dtype=float)), 2, 26.0, TotalCost()),
    "ASYM-5, 2, 14": (Travel(EXPLICIT, matrix=np.array(ASYM_5, dtype=float)), 2, 14.0, TotalCost()),
    "SQUARE-4, 2, makespan": (Travel("euclidean", np.array(SQUARE_4, dtype=float)), 2, np.inf, Makespan()),
    "GAP-5, 2, makespan": (Travel("manhattan", np.array(GAP_5, dtype=float)), 2, np.inf, Makespan()),
    "OCTO-8, 2, 35": (Travel("euclidean", np.array(OCTO_8, dtype=float)), 2, 35.0, TotalCost()),
}
"""Travel, vehicles, limit of distance and objective; the numbers of a name are vehicles and limit."""


def case(name: str) -> wb.RoutingProblem:
    """The problem of that name in ``CASES``."""
    travel, vehicles, limit, objective = CASES[name]
    return wb.RoutingProblem(wb.Sites.of(range(len(travel))), travel, (wb.VehicleType(vehicles, max_distance=limit),), objective, name=name)


def optimum(problem: wb.RoutingProblem, form: str, *, relax: bool = False) -> float:
    """The optimum that HiGHS proves for one form."""
    model: Any = problem.compile(form, relax=relax).program.to_highs()
    # HiGHS 1.12 to 1.15 cut optima of tiny routing programs off with this rule (HiGHS#3090).
    for option, value in (("mip_rel_gap", 0.0), ("threads", 1), ("presolve_rule_off", 4096), ("output_flag", False)):
        model.setOptionValue(option, value)
    model.run()
    return float(model.getInfo().objective_function_value)


def table(names: Sequence[str] = tuple(CASES)) -> list[list[str]]:
    """Rows of text, the header first."""
    ordered = sorted((f for f in FORMS.values() if f.family == "routing" and f.exactness is wb.Exactness.EXACT), key=lambda f: f.order)
    forms = [f.name for f in ordered if f.makes(case(next(iter(CASES)))) <= INTEGERS]
    lines = [["instance, vehicles, limit", *forms, "optimum"]]
    for name in names:
        problem = case(name)
        can = problem.forms()
        roots = [f"{optimum(problem, form, relax=True):.6g}" if form in can else "-" for form in forms]
        lines.append([name, *roots, f"{optimum(problem, can[0]):.6g}"])
    return lines


@command
def main(only: Annotated[list[str] | None, Option(choices=CASES, action="append", help="an instance; all by default")] = None) -> None:
    for row in table(only or tuple(CASES)):
        print(markdown_row(row))
