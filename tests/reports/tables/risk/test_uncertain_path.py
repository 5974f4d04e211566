import networkx as nx
from uncertain_graphs import WORKED, graph_of

import waybound as wb
from waybound.reports.tables.facts import facts, facts_table


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
