import networkx as nx
from risk_problems import problem
from uncertain_graphs import WORKED, graph_of

import waybound as wb
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


def test_a_graph_is_told_by_sizes_and_ranges():
    rows = dict(facts_table(facts(wb.UncertainPath(graph_of(WORKED), 0.5))).rows)
    expected = {
        "problem": "uncertain-path, min mean + 0 x standard deviation", "vertices": "7, each left by 0 to 2 edges",
        "edges": "10: means 10 to 102, variances 1 to 9", "from, to": "S, G", "positions": "none",
    }  # fmt: skip
    assert {name: rows[name] for name in expected} == expected


def test_edges_that_share_a_cost_are_told():
    graph = nx.Graph()
    graph.add_edge("a", "b", mean=1, variance=1)
    rows = dict(facts_table(facts(wb.UncertainPath(wb.UncertainGraph.from_networkx(graph, start="a", goal="b")))).rows)
    assert rows["edges"] == "2, 1 of them at the cost of another: means 1 to 1, variances 1 to 1"
