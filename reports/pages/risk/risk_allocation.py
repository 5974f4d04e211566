"""The page of a risk allocation: the trajectory where there are dynamics, the risk of each constraint, and how many fail at once."""

from ....formulations.risk.risk_allocation import RiskAllocation
from ....formulations.solution import Solution
from .. import PAGES
from ..default_blocks import answer_table, charts
from ..rendering import Block


@PAGES.register("risk-allocation")
def answer_blocks(problem: RiskAllocation, answer: object, solution: Solution) -> list[Block]:
    """Pictures and the table."""
    trajectory = ["trajectory"] if problem.instance.quantities.dynamics is not None else []
    return [*(chart for _, chart in charts(solution, [*trajectory, "risks", "violations"])), answer_table(solution)]
