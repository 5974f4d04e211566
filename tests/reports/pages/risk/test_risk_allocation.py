import risk_problems

import waybound as wb
from waybound.reports.pages.blocks import DataTable, Figure
from waybound.reports.pages.risk.risk_allocation import answer_blocks


def test_without_dynamics_there_are_risks_and_failures_and_no_trajectory() -> None:
    solution = wb.solve(risk_problems.problem(), heuristic="iterative", bound_time=0)
    risks, failures, table = answer_blocks(solution.problem, solution.answer, solution)
    assert isinstance(risks, Figure) and isinstance(failures, Figure) and isinstance(table, DataTable)
    assert "Answer" in solution.to_html()


def test_a_trajectory_is_shown_once() -> None:
    solution = wb.solve(wb.generate("risk-allocation", family="corridor"), heuristic="iterative", bound_time=0)
    alts = [block.alt for block in answer_blocks(solution.problem, solution.answer, solution) if isinstance(block, Figure)]
    assert alts == ["Trajectory of the answer", "Risks of the answer", "Violations of the answer"]
