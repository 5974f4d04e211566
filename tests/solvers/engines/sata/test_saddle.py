import json
import warnings
from dataclasses import replace

import numpy as np
import pytest
from draws import ALL, draws
from hypothesis import HealthCheck, given, settings
from random_sensing import chain_graph, even_graph, optimum, random_graph
from ratio_strategies import graphs

from waybound import BottleneckSATA, Evidence, MaxMinLP, UnsupportedError, UsageError, solve
from waybound.formulations.certificate import check_certificate
from waybound.formulations.sata.balls import coverage, even_shares
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.sata.saddle import LEAST_GAP, Saddle
from waybound.solvers.isolation import run_isolated


def lp(graph) -> BottleneckSATA:
    return BottleneckSATA(graph, fractional=True)


def run(graph, control=None, **options):
    result = Saddle().run(lp(graph), Options(**{"time_limit": 60.0, **options}), control or Control())
    evaluation = lp(graph).evaluate(result.answer)
    assert evaluation.feasible
    assert evaluation.values[0] == pytest.approx(result.objective, rel=1e-9)
    for evidence in result.evidence:
        assert verified_bound(lp(graph), evidence) <= result.bound * (1 + 1e-12)
    return result


# -- optima -----------------------------------------------------------------------------------------------------------


@settings(deadline=None, max_examples=draws(60), suppress_health_check=[HealthCheck.too_slow])
@given(graphs(every_target_seen=True))
def test_tiny_graphs_are_solved_to_their_optimum(graph):
    result = run(graph)
    best = optimum(graph)
    assert result.status == "optimal"
    assert result.objective == pytest.approx(best, rel=1e-6, abs=1e-9)
    assert result.bound >= best * (1 - 1e-9)


@pytest.mark.share(3)
@pytest.mark.parametrize("gap", [0.1, 1e-2, 1e-4])
@pytest.mark.parametrize("make", [random_graph, even_graph, chain_graph])
@pytest.mark.parametrize("seed", range(2 if ALL else 1))
def test_the_gap_asked_for_is_closed_with_both_sides_proved(seed, make, gap):
    graph = make(seed, 400)
    result, best = run(graph, gap=gap), optimum(graph)
    assert result.limit in ("gap", "none")
    assert result.objective <= best * (1 + 1e-9) <= result.bound * (1 + 2e-9)
    assert result.bound <= result.objective * (1 + gap)


def test_regret_matching_finishes_where_all_targets_matter():
    graph = even_graph(1, 4000)
    result = run(graph, gap=1e-3)
    assert result.limit == "gap"
    assert result.statistics["steps"] > 0
    assert result.bound <= result.objective * 1.001


@pytest.mark.long
def test_a_gap_of_zero_ends_within_what_counts_as_an_optimum():
    graph = even_graph(2, 1000)
    result, best = run(graph, time_limit=300.0), optimum(graph)
    assert (result.status, result.limit) == ("optimal", "none")
    assert result.bound - result.objective <= LEAST_GAP * result.objective
    assert result.objective == pytest.approx(best, rel=1e-6)


# -- unusual graphs ---------------------------------------------------------------------------------------------------


def test_one_robot_divides_itself():
    graph = graph_of_edges([0, 0, 0], [0, 1, 2], [0, 1, 2], [1.0, 2.0, 4.0], robots=1)
    result = run(graph)
    assert result.status == "optimal"
    assert result.objective == pytest.approx(4 / 7, rel=1e-6)


def test_robots_of_one_action_have_no_choice():
    graph = graph_of_edges([0, 1, 2], [0, 1, 2, 2], [0, 1, 0, 1], [1.0, 2.0, 3.0, 4.0], robots=3)
    result = run(graph)
    assert (result.status, result.objective) == ("optimal", pytest.approx(4.0))
    assert result.answer.tolist() == [1.0, 1.0, 1.0]


def test_idle_robots_and_actions_that_see_nothing_do_no_harm():
    graph = graph_of_edges([0, 0, 2, 2, 2], [0, 2, 3], [0, 1, 0], [1.0, 1.0, 0.5], robots=4, targets=2)
    result = run(graph)
    assert result.status == "optimal"
    assert result.objective == pytest.approx(optimum(graph), rel=1e-6)


def test_actions_may_be_in_any_order():
    graph = random_graph(3, robots=200, targets=150)
    order = np.random.default_rng(0).permutation(graph.num_actions)
    place = np.argsort(order)
    mixed = graph_of_edges(graph.robot_of_action[order], place[graph.action_of_edge], graph.indices, graph.weights, robots=200, targets=150)
    assert run(mixed).objective == pytest.approx(run(graph).objective, rel=2e-6)


@pytest.mark.parametrize("spread", [3.0, 6.0])
def test_widely_spread_weights(spread):
    graph = random_graph(4, robots=300, targets=200, spread=spread)
    result = run(graph)
    assert result.status == "optimal"
    assert result.objective == pytest.approx(optimum(graph), rel=1e-5)


@pytest.mark.parametrize("size", [1e-150, 1e-9, 1e9, 1e150])
def test_weights_of_any_size(size):
    graph = random_graph(5, robots=100, targets=60)
    result = run(replace(graph, weights=graph.weights * size))
    assert result.objective / size == pytest.approx(optimum(graph), rel=1e-6)


@pytest.mark.share(4)
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("decades", [20, 120, 290])
def test_weights_of_all_sizes_at_once_end_in_true_claims(seed, decades):
    graph = random_graph(seed, robots=12, targets=8)
    rng = np.random.default_rng(seed)
    result = run(replace(graph, weights=10.0 ** rng.uniform(-decades, decades, graph.num_edges)), iterations=200)
    assert 0.0 < result.objective <= result.bound * (1 + 1e-12)


def test_a_target_that_nobody_sees_makes_the_value_zero_by_proof():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        graph = SensingGraph.from_edges([0, 0], [0, 1], [0, 1], robots=1, targets=3)
    solution = solve(lp(graph), "saddle")
    assert (solution.status, solution.objective, solution.bound, solution.bound_kind) == ("optimal", 0.0, 0.0, "verified")
    assert "no action sees" in solution.message


def test_no_actions_at_all():
    graph = graph_of_edges([], [], [], robots=2, targets=2)
    result = run(graph)
    assert (result.status, result.objective) == ("optimal", 0.0)


# -- packing and covering rows ----------------------------------------------------------------------------------------


def random_program(seed: int) -> MaxMinLP:
    rng = np.random.default_rng(seed)
    n, rows = 120, 40
    packing = np.zeros((rows, n))
    packing[np.arange(n) % rows, np.arange(n)] = rng.uniform(0.2, 5.0, n)
    covering = rng.uniform(0.5, 1.5, (30, n)) * (rng.random((30, n)) < 0.1)
    covering[:, 0] += 0.01
    return MaxMinLP(packing, covering)


@pytest.mark.parametrize("seed", range(3))
def test_programs_with_one_packing_row_a_variable(seed):
    problem = random_program(seed)
    solution = solve(problem, "saddle", time_limit=60.0)
    peer = solve(problem, "highs", bound_time=0.0)
    assert solution.status == "optimal"
    assert solution.bound_kind == "verified"
    assert solution.objective == pytest.approx(peer.objective, rel=2e-6)
    assert solution.certificate.evidence[0].kind == "packing-covering-duals"


def test_other_problems_are_refused_by_what_they_have():
    with pytest.raises(UnsupportedError, match="whole-actions"):
        solve(BottleneckSATA(random_graph(1)), "saddle")


# -- evidence ---------------------------------------------------------------------------------------------------------


def test_its_bound_is_verified_in_the_certificate_and_again_from_the_file():
    problem = lp(random_graph(6, robots=300, targets=200))
    solution = solve(problem, "saddle", gap=1e-3)
    assert solution.bound_kind == "verified"
    assert solution.gap <= 1e-3
    assert solution.certificate.bound == solution.bound
    written = json.loads(json.dumps(solution.certificate.to_json(with_evidence=True)))
    checked = check_certificate(problem, written, problem.evaluate(solution.answer))
    assert checked.bound == solution.certificate.bound


def test_no_other_method_bounds_it_again(monkeypatch):
    monkeypatch.setattr("waybound.solving.concluding.bounded", lambda *_, **__: pytest.fail("bounded again"))
    solution = solve(lp(even_graph(3, 2000)), "saddle", iterations=3, bound_time=30.0)
    assert solution.bound_source.startswith("prices of")


def test_evidence_comes_back_from_a_process_of_its_own():
    problem = lp(random_graph(7, robots=100, targets=60))
    solution = solve(problem, "saddle", gap=1e-3, isolate=True)
    assert solution.bound_kind == "verified"
    assert solution.certificate.evidence
    assert solution.gap <= 1e-3


@pytest.mark.slow
def test_evidence_outlives_a_process_that_is_ended(monkeypatch):
    monkeypatch.setattr("waybound.solvers.isolation.GRACE", 0.0)
    control = Control()
    heard = []
    control._progress = lambda event: (heard.append(event), len(heard) > 3 and control.stop())
    result = run_isolated("saddle", lp(even_graph(4, 20000)), Options(time_limit=60.0), control)
    assert result.limit == "interrupt"
    assert result.evidence
    assert all(isinstance(e, Evidence) for e in result.evidence)
    assert verified_bound(lp(even_graph(4, 20000)), result.evidence[0]) == pytest.approx(result.bound, rel=1e-9)


# -- limits -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("iterations", [1, 7, 60])
def test_work_limits_repeat_to_the_bit(iterations):
    graph = even_graph(5, 3000)
    first, second = (run(graph, iterations=iterations) for _ in range(2))
    assert first.limit == "iterations"
    assert np.array_equal(first.answer, second.answer)
    assert (first.objective, first.bound, first.evidence) == (second.objective, second.bound, second.evidence)
    assert first.statistics == second.statistics
    assert first.statistics["passes"] <= iterations + 1


def test_more_work_is_no_worse():
    graph = even_graph(6, 3000)
    results = [run(graph, iterations=k) for k in (1, 10, 100, 1000)]
    values, bounds = [r.objective for r in results], [r.bound for r in results]
    assert values == sorted(values)
    assert bounds == sorted(bounds, reverse=True)
    assert values[-1] > values[0]


def test_a_tiny_time_limit_leaves_an_answer_and_a_bound():
    graph = even_graph(7, 3000)
    result = run(graph, time_limit=1e-6)
    assert (result.status, result.limit) == ("feasible", "time")
    assert 0 < result.objective < result.bound < np.inf


@pytest.mark.slow
def test_a_time_limit_is_kept():
    assert run(even_graph(8, 20000), time_limit=1.0).limit == "time"


def test_an_interrupt_keeps_the_best_answer_and_bound():
    control, seen = Control(), []

    def hear(event):
        seen.append(event)
        if len(seen) == 5:
            control.stop()

    control._progress = hear
    result = run(even_graph(9, 20000), control)
    assert (result.status, result.limit) == ("feasible", "interrupt")
    assert result.objective >= max(e["objective"] for e in seen if e["objective"] is not None) * (1 - 1e-12)
    assert result.evidence


def test_an_interrupt_before_the_run_ends_it_at_once():
    control = Control()
    control.stop()
    result = run(even_graph(10, 5000), control)
    assert result.limit == "interrupt"
    assert result.objective > 0


def test_what_is_published_gets_better_and_is_true():
    graph, events = random_graph(11, robots=300, targets=200), []

    class Listening(Control):
        def publish(self, answer=None, objective=None, bound=None, evidence=()):
            super().publish(answer, objective, bound, evidence)
            if answer is not None:
                assert lp(graph).evaluate(answer).feasible
                assert coverage(graph, answer).min() == pytest.approx(objective, rel=1e-9)
            if bound is not None:
                assert verified_bound(lp(graph), evidence[0]) == pytest.approx(bound, rel=1e-9)
            events.append((self.objective, self.bound))

    result = run(graph, Listening())
    values = [v for v, _ in events if v is not None]
    bounds = [b for _, b in events if b is not None]
    assert values == sorted(values)
    assert bounds == sorted(bounds, reverse=True)
    assert (values[-1], bounds[-1]) == (result.objective, result.bound)


# -- starts and options -----------------------------------------------------------------------------------------------


def test_a_start_is_kept_if_nothing_better_is_found():
    graph = even_graph(12, 3000)
    good = run(graph, gap=1e-3)
    again = run(graph, start=good.answer, iterations=1)
    assert again.objective >= good.objective * (1 - 1e-12)
    assert again.statistics["start"] == "used"


def test_a_start_that_does_not_use_its_robots_up_is_completed():
    graph = random_graph(13)
    result = run(graph, start=0.25 * even_shares(graph))
    assert result.objective == pytest.approx(optimum(graph), rel=1e-6)


def test_a_start_that_is_no_answer_is_ignored():
    result = run(random_graph(14), start=np.full(3, np.nan))
    assert result.statistics["start"] == "ignored"


@pytest.mark.parametrize("h", [2, "3"])
def test_the_local_algorithm_may_start_it(h):
    graph = random_graph(15, robots=200, targets=120)
    result = run(graph, extra={"h": h})
    assert result.objective == pytest.approx(optimum(graph), rel=1e-6)
    first = run(even_graph(16, 3000), extra={"h": h}, iterations=1)
    assert first.objective >= coverage(even_graph(16, 3000), even_shares(even_graph(16, 3000))).min()


@pytest.mark.parametrize("extra", [{"h": -1}, {"h": "two"}, {"h": True}, {"h": 1001}, {"height": 2}])
def test_options_out_of_range_are_refused(extra):
    with pytest.raises(UsageError, match="h"):
        run(random_graph(17), extra=extra)
