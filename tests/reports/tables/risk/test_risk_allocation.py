from risk_problems import problem

from waybound.formulations.risk.allocations import Allocation
from waybound.reports.tables.answers import answer_tables
from waybound.reports.tables.facts import facts, facts_table


def test_the_chain_from_the_budget_to_what_is_true() -> None:
    each, together = answer_tables(problem(), Allocation.of([1.0, 3.4], [0.02, 0.06]))
    assert each.rows == (("2", "0.06", "0.0548"), ("1", "0.02", "3.167e-05"))
    assert together.rows[0] == ("allowed", "0.1 in total, allocated")
    assert together.rows[2] == ("any fails", "0.05483 (exact)")
    assert together.rows[3] == ("conservatism", "45.2% of the total is not used")
    assert answer_tables(problem(), None) == []


def test_joint_risk_allows_no_constraint_one_of_its_own() -> None:
    each = answer_tables(problem(risk__kind="joint"), Allocation.of([1.0, 3.4]))[0]
    assert [column.name for column in each.columns] == ["constraint", "risk"] and each.rows[0] == ("2", "0.0548")


def test_budgets_are_told() -> None:
    rows = dict(facts_table(facts(problem(risk__budgets=[{"name": "arm", "constraints": ["1"], "risk": 0.02}]))).rows)
    assert rows["budgets"] == "total 0.1, arm 0.02"
    many = [{"name": f"b{k}", "constraints": ["1"], "risk": 0.02} for k in range(6)]
    assert dict(facts_table(facts(problem(risk__budgets=many))).rows)["budgets"] == "7, the first total of 0.1"
