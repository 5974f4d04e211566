import numpy as np
import pytest
from coded import coded
from uncertain_graphs import WORKED, graph_of, named

import waybound as wb
from waybound import UncertainPath, UsageError
from waybound.heuristics.risk.rags import RiskAware
from waybound.instances.generating import generate
from waybound.solvers.engines.risk.non_dominated_paths import NonDominated, non_dominated_paths


@pytest.fixture
def graph():
    return graph_of(WORKED)


def unobserved(graph, **options):
    rags = RiskAware(graph, non_dominated_paths(graph), **options)
    at, known, path = graph.start, np.full(graph.num_edges, np.nan), [graph.start]
    while at != graph.goal:
        at = rags.next_vertex(at, known)
        path.append(at)
    return named(graph, tuple(path)), [{graph.vertex_name(v): risk for v, risk in step.items()} for step in rags.risks]


@pytest.mark.parametrize("rule", ["best", "scan"])
def test_the_route_and_risks_of_the_source(graph, rule):
    route, risks = unobserved(graph, rule=rule)
    assert route == "S-B-C-G"
    assert risks[0] == pytest.approx({"A": 0.581475, "B": 0.418525}, abs=1e-6)
    assert risks[1]["C"] == pytest.approx(0.296206, abs=1e-6)
    assert risks[2] == pytest.approx({"G": 0.360405, "D": 1 - 0.360405}, abs=1e-6)
    assert RiskAware(graph, non_dominated_paths(graph), rule=rule).route() == tuple(graph.vertex_numbers[v] for v in "SBCG")


def test_joint_comparison_gives_the_exact_risks(graph):
    route, risks = unobserved(graph, comparison="joint")
    assert route == "S-B-C-G"
    assert [risks[0]["B"], risks[1]["C"], risks[2]["G"]] == pytest.approx([0.44461, 0.32824, 0.34866], abs=1e-4)


def test_a_shared_first_edge_is_counted_once(graph):
    _, risks = unobserved(graph, first_edges="shared")
    assert 0.418525 < risks[0]["B"] < 0.44461  # nearer to the exact one


@pytest.mark.parametrize(("observed", "goes", "chance"), [(73, "A", 0.632815), (75, "B", 0.416547), (77, "B", 0.220332)])
def test_observed_edges_change_the_choice(graph, observed, goes, chance):
    rags = RiskAware(graph, non_dominated_paths(graph))
    known = np.full(graph.num_edges, np.nan)
    known[graph.edges_of((graph.start, graph.vertex_numbers["A"]))] = observed
    known[graph.edges_of((graph.start, graph.vertex_numbers["B"]))] = 50.0
    assert graph.vertex_name(rags.next_vertex(graph.start, known)) == goes
    assert 1.0 - rags.risks[0][graph.vertex_numbers["A"]] == pytest.approx(chance, abs=1e-6)


def star(sets):
    """A graph whose start leads to one vertex a set, and from each by ways of the set's costs, through vertices of their own."""
    edges = []
    for name, costs in sets.items():
        edges.append(("S", name, 0.0, 0.0))
        for k, (mean, variance) in enumerate(costs):
            edges += [(name, f"{name}{k}", mean, variance), (f"{name}{k}", "G", 0.0, 0.0)]
    return graph_of(edges)


CYCLE = {"A": [(2.5, 36), (1.75, 0.01)], "B": [(1, 4)], "C": [(1.4, 0.01)]}


@pytest.mark.parametrize(("rule", "goes"), [("best", "B"), ("scan", "A")])
def test_where_pairs_are_not_transitive_the_best_rule_takes_the_likeliest(rule, goes):
    g = star(CYCLE)
    paths = non_dominated_paths(g, "strict")
    every = tuple((0, g.vertex_numbers[n], g.vertex_numbers[f"{n}{k}"], g.goal) for n, costs in CYCLE.items() for k in range(len(costs)))
    sums = np.array([[g.mean[g.edges_of(p)].sum(), g.variance[g.edges_of(p)].sum()] for p in every])
    rags = RiskAware(g, NonDominated(every, sums[:, 0], sums[:, 1]), rule=rule)
    assert g.vertex_name(rags.next_vertex(g.start, np.full(g.num_edges, np.nan))) == goes
    if rule == "best":
        chances = {g.vertex_name(v): 1 - risk for v, risk in rags.risks[0].items()}
        assert chances == pytest.approx({"A": 0.3674, "B": 0.3929, "C": 0.2397}, abs=5e-5)
    assert set(paths.paths) <= set(every)


def test_equal_successors_go_to_the_first_of_the_least_mean():
    g = star({"A": [(3, 2)], "B": [(3, 2)], "C": [(3, 2)]})
    rags = RiskAware(g, non_dominated_paths(g, "pareto"))
    assert g.vertex_name(rags.next_vertex(g.start, np.full(g.num_edges, np.nan))) == "A"
    assert list(rags.risks[0].values()) == pytest.approx([2 / 3] * 3)


def test_a_fresh_walk_knows_nothing_of_the_last():
    g = generate("prm-graph", 4, vertices=30)
    rags = RiskAware(g, non_dominated_paths(g))
    first = rags.route()
    assert rags.fresh().route() == first
    assert rags.risks == []
    assert first[-1] == g.goal


@pytest.mark.parametrize("options", [{"rule": "worst"}, {"comparison": "none"}, {"first_edges": "all"}])
def test_unknown_options_are_refused(graph, options):
    with pytest.raises(UsageError, check=coded("unknown-name")):
        RiskAware(graph, non_dominated_paths(graph), **options)


def test_it_takes_the_route_of_the_source_which_no_risk_asks_for():
    problem = UncertainPath(graph_of(WORKED), 0.05)
    solution = wb.solve(problem, heuristic="rags")
    assert named(problem.graph, solution.answer) == "S-B-C-G"
    assert solution.objective > solution.bound
    assert solution.certificate.guarantee is None


@pytest.mark.parametrize("options", [{"comparison": "joint"}, {"rule": "scan"}, {"dominance": "strict"}, {"first_edges": "shared"}])
def test_its_options_are_taken(options):
    assert wb.solve(UncertainPath(graph_of(WORKED), 0.05), heuristic="rags", **options).certificate.feasible
