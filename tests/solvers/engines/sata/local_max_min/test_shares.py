import math
from dataclasses import replace
from fractions import Fraction as F

import numpy as np
import pytest
from coded import coded
from draws import draws
from hypothesis import example, given, settings, strategies as st
from random_sensing import optimum
from sata_cases import CASES, relabelled
from truth.local_algorithm import FIGURE_33, ExactLocal, Robots, cycle, graph_of, random_graph, regular_tree, robots_of

from waybound import BottleneckSATA, UsageError
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges
from waybound.solvers.engines.sata.local_max_min import search
from waybound.solvers.engines.sata.local_max_min.cleaning import clean
from waybound.solvers.engines.sata.local_max_min.messages import exchange
from waybound.solvers.engines.sata.local_max_min.search import MARGIN
from waybound.solvers.engines.sata.local_max_min.shares import local_shares, shares_at_levels

D: Robots = [[{1: 1}, {2: 1}], [{2: 1}, {3: 1}]]
REFERENCE: dict[str, tuple[Robots, F, dict[int, tuple[str, str, str]]]] = {
    "A": (FIGURE_33, F(4, 3), {
        1: ("2 2 3 2 2 3", "1/2 1/2 1/2 1/2 1/2 1/2", "1"),
        2: ("2 2 2 3/2 3/2 2", "1/2 1/2 2/3 1/3 1/3 2/3", "7/6"),
        3: ("5/3 5/3 3/2 7/5 3/2 3/2", "119/240 121/240 59/80 21/80 13/48 35/48", "49/40"),
        5: ("10/7 7/5 13/9 15/11 7/5 11/8", "9301/18480 9179/18480 7235/9504 2269/9504 1519/5280 3761/5280", "44929/36960"),
    }),
    "B": ([[{0: 1}, {1: 1}, {2: 1}]], F(1, 3), {
        h: (f"{t} {t} {t}", "1/3 1/3 1/3", "1/3") for h, t in ((1, "2/3"), (2, "1/2"), (3, "4/9"), (5, "2/5"))
    }),
    "C": ([[{0: 2, 1: 3}]], F(2), {h: (t, "1", "2") for h, t in ((1, "4"), (2, "3"), (3, "8/3"), (5, "12/5"))}),
    "D": (D, F(2, 3), {
        1: ("2 1 1 2", "1/2 1/2 1/2 1/2", "1/2"),
        2: ("1 1 1 1", "2/3 1/3 1/3 2/3", "2/3"),
        3: ("1 4/5 4/5 1", "13/20 7/20 7/20 13/20", "13/20"),
        5: ("4/5 3/4 3/4 4/5", "79/120 41/120 41/120 79/120", "79/120"),
    }),
    "E": ([[{1: 2}, {2: 1}], [{2: 3}, {3: 1}]], F(8, 9), {
        2: ("1 2 1 2", "2/3 1/3 5/18 13/18", "13/18"),
        3: ("1 1 1 2", "1/2 1/2 5/24 19/24", "19/24"),
        5: ("1 1 14/15 1", "37/90 53/90 2/15 13/15", "37/45"),
    }),
    "F": ([[{1: 1, 2: 1}, {2: 2, 3: 1}, {3: 1}], [{1: 1}, {2: 3}, {3: 1, 4: 1}]], F(1), {
        2: ("2/3 2/3 2/3 2/3 2/3 4/3", "4/9 2/9 2/9 1/9 1/9 5/9", "5/9"),
        5: ("2/3 2/3 2/3 2/3 2/3 2/3", "5/9 1/9 1/9 1/18 1/18 11/18", "11/18"),
    }),
    "G": ([[{1: 1}], [{1: 1, 2: 1}, {3: 1}], [{2: 1}, {3: 1}, {4: 1}, {4: 1, 1: 1}]], F(2, 3), {
        2: ("1 1 1 3/4 3/4 3/4 3/4", "1 1/2 1/2 1/8 1/8 1/4 1/4", "1/2"),
    }),
}  # fmt: skip
"""Cases with exact levels: instance, optimum, and for each h levels, shares (not normalised) and value."""

REFERENCE_RUNS = [(name, h) for name, (_, _, runs) in REFERENCE.items() for h in runs]


def fractions(text: str) -> list[F]:
    return [F(part) for part in text.split()]


def value(graph: SensingGraph, shares: np.ndarray) -> float:
    """The least coverage of a target that somebody sees."""
    seen = np.bincount(graph.indices, minlength=graph.num_targets) > 0
    return float(BottleneckSATA(graph, fractional=True).coverage(shares)[seen].min())


def compact(graph: SensingGraph) -> SensingGraph:
    """Without targets that nobody sees."""
    seen, target = np.unique(graph.indices, return_inverse=True)
    return graph_of_edges(graph.robot_of_action, graph.action_of_edge, target, graph.weights, robots=graph.num_robots, targets=len(seen))


# -- the reference cases -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "h"), REFERENCE_RUNS)
def test_the_exact_oracle_gives_the_reference_cases(name: str, h: int) -> None:
    robots, best, runs = REFERENCE[name]
    levels, shares, worst = runs[h]
    exact = ExactLocal(robots, h)
    assert exact.largest_levels() == fractions(levels)
    assert exact.shares(exact.largest_levels()) == fractions(shares)
    assert exact.value(fractions(shares)) == F(worst)
    assert optimum(compact(graph_of(robots))) == pytest.approx(float(best), abs=1e-9)


@pytest.mark.parametrize(("name", "h"), REFERENCE_RUNS)
def test_arrays_give_the_reference_cases_at_exact_levels(name: str, h: int) -> None:
    robots, _, runs = REFERENCE[name]
    levels, shares, worst = runs[h]
    graph = graph_of(robots)
    found = shares_at_levels(clean(graph), np.array([float(t) for t in fractions(levels)]), h, normalise=False)
    assert found == pytest.approx([float(x) for x in fractions(shares)], abs=1e-14)
    assert value(graph, found) == pytest.approx(float(F(worst)), abs=1e-14)


@pytest.mark.parametrize(("name", "h"), REFERENCE_RUNS)
def test_a_fine_search_finds_the_reference_levels(name: str, h: int) -> None:
    robots, _, runs = REFERENCE[name]
    levels = [float(t) for t in fractions(runs[h][0])]
    found = local_shares(graph_of(robots), h, eps=1e-6, normalise=False)
    # The secant's root lies between two levels: exact levels are met to the precision of eps, mostly far better.
    assert found.levels == pytest.approx(levels, rel=1e-6)
    assert found.shares == pytest.approx([float(x) for x in fractions(runs[h][1])], abs=2e-5)


TABLE_31 = {
    2: (0.5, 0.5, 0.6667, 0.3333, 0.3333, 0.6667),
    10: (0.5, 0.5, 0.7591, 0.2409, 0.2409, 0.7591),
    30: (0.5, 0.5, 0.7855, 0.2145, 0.2145, 0.7855),
}


@pytest.mark.parametrize("h", TABLE_31)
@pytest.mark.parametrize("run", [local_shares, exchange])
@pytest.mark.parametrize("step", [0.1, 0.05])
def test_table_31_of_the_thesis_comes_out_of_both_versions(h: int, run, step: float) -> None:
    found = run(graph_of(FIGURE_33), h, search="step", step=step, normalise=False)
    assert found.shares == pytest.approx(TABLE_31[h], abs=5e-5)
    assert found.levels == pytest.approx({2: [2, 2, 2, 1.5, 1.5, 2]}.get(h, [1.3] * 6), abs=1e-12)


def test_table_31_is_not_what_exact_levels_give() -> None:
    found = local_shares(graph_of(FIGURE_33), 30, eps=1e-6, normalise=False)
    assert np.abs(found.shares - TABLE_31[30]).max() > 0.01


S1, S1W, S6, S7, S10 = (CASES[name].graph for name in ("S1", "S1w", "S6", "S7", "S10"))
SMALL_CASES = [
    (S1, (1, 1.1667, 1.2156, 1.2498, 1.1980)), (S1W, (3, 3.7752, 3.9563, 4.0007, 3.9290)), (S6, (1, 1.1667, 1.1815, 1.1646, 1.0645)),
    (S7, (1.5, 1.5556, 1.6477, 1.6570, 1.6901)), (S10, (3, 3.8872, 4.3917, 4.4174, 4.4785)),
]  # fmt: skip


def value_at_exact_levels(graph: SensingGraph, h: int) -> float:
    exact = ExactLocal(robots_of(graph), h)
    levels = exact.largest_levels()
    found = shares_at_levels(clean(graph), np.array([float(t) for t in levels]), h, normalise=False)
    assert value(graph, found) == pytest.approx(float(exact.value(exact.shares(levels))), abs=1e-9)
    return value(graph, found)


@pytest.mark.share(2)
@pytest.mark.parametrize(("graph", "values"), SMALL_CASES)
def test_values_of_small_cases(graph: SensingGraph, values: tuple[float, ...]) -> None:
    assert [value_at_exact_levels(graph, h) for h in (1, 2, 5, 10, 30)] == pytest.approx(values, abs=5.1e-5)
    # The search's margin is multiplied with every layer, so a comparison to 4 digits ends at moderate heights.
    found = [value(graph, local_shares(graph, h, eps=1e-6, normalise=False).shares) for h in (1, 2, 5, 10)]
    assert found == pytest.approx(values[:4], abs=6e-5)


@pytest.mark.long
@pytest.mark.parametrize(("graph", "last"), [(S1, 1.176288), (S1W, 3.908610), (S6, 103 / 101), (S7, 1.706860), (S10, 4.603334)])
def test_at_height_100_only_exact_arithmetic_has_an_exact_value(graph: SensingGraph, last: float) -> None:
    exact = ExactLocal(robots_of(graph), 100)
    levels = exact.largest_levels()
    assert float(exact.value(exact.shares(levels))) == pytest.approx(last, abs=1e-6)
    # A layer may double a difference of levels: that of their rounding to doubles, 1e-16, is then all there is after 50 layers.
    rounded = shares_at_levels(clean(graph), np.array([float(t) for t in levels]), 100, normalise=False)
    assert value(graph, rounded) == pytest.approx(last, abs=0.005)


@pytest.mark.parametrize(
    ("h", "shares"),
    [
        (5, (0.5033, 0.4967, 0.7613, 0.2387, 0.2877, 0.7123)),
        (10, (0.5106, 0.4894, 0.7905, 0.2095, 0.2498, 0.7502)),
        (30, (0.5042, 0.4958, 0.8172, 0.1828, 0.1980, 0.8020)),
    ],
)
def test_shares_of_figure_33_at_exact_levels(h: int, shares: tuple[float, ...]) -> None:
    assert local_shares(S1, h, eps=1e-6, normalise=False).shares == pytest.approx(shares, abs=6e-5)


def test_the_step_search_on_figure_33_at_other_heights() -> None:
    assert local_shares(S1, 1, search="step", normalise=False).shares == pytest.approx([0.5] * 6)
    found = local_shares(S1, 5, search="step", normalise=False).shares
    assert found == pytest.approx((0.4917, 0.5083, 0.7250, 0.2750, 0.2583, 0.7417), abs=5e-5)
    assert value(S1, found) == pytest.approx(1.2333, abs=5e-5)


@pytest.mark.parametrize("h", [1, 2, 3, 5, 10, 30, 100])
def test_a_robot_of_two_nested_actions_has_a_closed_form_on_which_the_bound_is_met_at_height_one(h: int) -> None:
    graph = CASES["S8"].graph
    found = local_shares(graph, h, eps=1e-6).shares
    assert found == pytest.approx([1 - 1 / (2 * h), 1 / (2 * h)], abs=1e-6)
    assert 1 / value(graph, found) <= (1 + 1 / h) * (1 + 2e-6)
    if h == 1:
        assert 1 / value(graph, found) == pytest.approx(2.0, abs=1e-6)


# -- the exact oracle ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@settings(max_examples=draws(60))
@given(st.integers(0, 10**6), st.integers(1, 4), st.sampled_from([0.02, 0.1, 0.5]))
@example(123, 4, 0.02)  # a copy that is in no tree of the root falls to -5e6 caps
def test_the_secant_search_agrees_with_exact_arithmetic(seed: int, h: int, eps: float) -> None:
    graph = random_graph(np.random.default_rng(seed), most_robots=5)
    exact = ExactLocal(robots_of(graph), h)
    found = local_shares(graph, h, eps=eps, normalise=False)
    levels = found.levels[exact.number]
    assert levels == pytest.approx([float(t) for t in exact.secant_levels(eps)], rel=1e-12)
    best = np.array([float(t) for t in exact.largest_levels()])
    assert (levels <= best * (1 + 1e-12)).all()
    assert (levels * (1 + eps) >= best * (1 - 1e-12)).all()
    used = [F(float(t)) * (1 - F(MARGIN)) for t in levels]
    assert found.shares == pytest.approx(exact.spread(exact.shares(used)), abs=1e-12)


@settings(max_examples=draws(20))
@given(st.integers(0, 10**6), st.integers(2, 13), st.sampled_from(["secant", "step"]))
@example(107, 13, "secant")
@example(22, 12, "step")
def test_weights_of_many_sizes_bury_no_level_under_rounding(seed: int, h: int, search: str) -> None:
    graph = random_graph(np.random.default_rng(seed), most_robots=3, most_actions=3, weights="decades")
    exact = ExactLocal(robots_of(graph), h)
    best = np.array([float(t) for t in exact.largest_levels()])
    step = max(float(min(exact.ceilings)) / 100, float(max(exact.ceilings)) / 10_000)
    for find in (local_shares, exchange):
        found = find(graph, h, search=search, step=step, normalise=False)
        levels = found.levels[exact.number]
        assert (levels <= best * (1 + MARGIN)).all()
        assert (levels * (1 + found.relative_eps) >= best * (1 - MARGIN)).all()


@settings(max_examples=draws(60))
@given(st.integers(0, 10**6), st.integers(1, 4), st.sampled_from(["0.1", "0.25", "1"]))
def test_the_step_search_agrees_with_exact_arithmetic(seed: int, h: int, step: str) -> None:
    graph = random_graph(np.random.default_rng(seed), most_robots=5)
    exact = ExactLocal(robots_of(graph), h)
    found = local_shares(graph, h, search="step", step=float(step), normalise=False)
    levels = found.levels[exact.number]
    assert levels == pytest.approx([float(t) for t in exact.stepped_levels(F(float(step)))], rel=1e-12)
    best = np.array([float(t) for t in exact.largest_levels()])
    assert (best <= levels * (1 + found.relative_eps)).all()
    used = [F(float(t)) * (1 - F(MARGIN)) for t in levels]
    assert found.shares == pytest.approx(exact.spread(exact.shares(used)), abs=1e-12)


@settings(max_examples=draws(60))
@given(st.integers(0, 10**6), st.integers(1, 4))
def test_smoothing_over_balls_uses_no_larger_levels(seed: int, h: int) -> None:
    graph = random_graph(np.random.default_rng(seed), most_robots=6)
    exact = ExactLocal(robots_of(graph), h)
    found = local_shares(graph, h, smoothing="ball", normalise=False)
    used = found.levels[exact.number] * (1 - MARGIN)
    owner = graph.robot_of_action
    near = np.eye(graph.num_robots, dtype=int)
    sees = np.zeros((graph.num_robots, graph.num_targets), dtype=int)
    sees[owner[graph.action_of_edge], graph.indices] = 1
    for _ in range(h - 1):
        near = ((near @ sees @ sees.T) > 0).astype(int) | near
    mine = owner[exact.number]
    smooth = [F(float(min(used[near[i][mine] > 0]))) for i in mine]
    z = exact.recursion(lambda v, layer: smooth[v])
    shares = [sum(z[c, v, layer] for c in "RB" for layer in range(h + 1)) / (2 * (h + 1)) for v in range(exact.size)]
    assert found.shares == pytest.approx(exact.spread(shares), abs=1e-12)
    least = exact.smoothed([F(float(t)) for t in used])
    assert all(smooth[v] <= least(v, layer) for v in range(exact.size) for layer in range(h))


# -- properties ----------------------------------------------------------------------------------------------------------


@settings(max_examples=draws(60))
@given(st.integers(0, 10**6), st.sampled_from([1, 2, 5, 10]), st.sampled_from(["secant", "step"]), st.booleans())
def test_shares_are_feasible_and_normalising_never_takes_from_a_target(seed: int, h: int, search: str, ball: bool) -> None:
    rng = np.random.default_rng(seed)
    graph = random_graph(rng, most_robots=20)
    wide = replace(graph, weights=np.exp(rng.uniform(-5, 5, graph.num_edges)))
    options = {"search": search, "smoothing": "ball" if ball else "layers"}
    plain, full = (local_shares(wide, h, normalise=n, **options).shares for n in (False, True))  # type: ignore[arg-type]
    for shares in (plain, full):
        load = np.bincount(wide.robot_of_action, shares, minlength=wide.num_robots)
        assert (shares >= 0).all()
        assert (load <= 1 + 4e-16).all()
    assert (full >= plain * (1 - 1e-15)).all()
    live = np.setdiff1d(np.arange(wide.num_robots), wide.idle_robots)
    assert np.bincount(wide.robot_of_action, full, minlength=wide.num_robots)[live] == pytest.approx(1.0, abs=1e-15)
    few = np.bincount(wide.robot_of_action[np.diff(wide.indptr) > 0], minlength=wide.num_robots) <= 2
    own = few[wide.robot_of_action]
    # One or two actions: the layered solution uses the robot up as it is, but for what falls to the caps.
    assert (full[own] - plain[own] <= 1e-9).all()


@settings(max_examples=draws(40))
@given(st.integers(0, 10**6), st.sampled_from([1, 2, 4]), st.sampled_from(["secant", "step"]))
def test_numbering_does_not_matter(seed: int, h: int, search: str) -> None:
    rng = np.random.default_rng(seed)
    graph = random_graph(rng, most_robots=12)
    other, action = relabelled(graph, rng)
    a, b = local_shares(graph, h, search=search).shares, local_shares(other, h, search=search).shares
    assert b[action] == pytest.approx(a, abs=1e-9 if search == "step" else 1e-11)


@settings(max_examples=draws(30))
@given(st.integers(0, 10**6), st.sampled_from([1, 2, 3]), st.sampled_from([0.005, 0.1]))
def test_where_the_search_looks_first_does_not_change_a_bit(seed: int, h: int, eps: float) -> None:
    rng = np.random.default_rng(seed)
    graph = random_graph(rng, most_robots=60, weights="spread")
    found = local_shares(graph, h, eps=eps)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "_LINEAR", 1)
        coarse = local_shares(graph, h, eps=eps)
        patch.setattr(search, "_LINEAR", 10**6)
        linear = local_shares(graph, h, eps=eps)
        patch.setattr(search, "_LINEAR", 14)
        patch.setattr(search, "_SAMPLE", (4, 1, 0.01))
        patch.setattr(search.SecantSearch, "_reach", lambda self, roots, limit: True)
        patch.setattr(np, "linspace", lambda low, high, size: np.array([low, high]))
        guessed = local_shares(graph, h, eps=eps)
    for other in (coarse, linear, guessed):
        assert other.levels.tobytes() == found.levels.tobytes()
        assert other.shares.tobytes() == found.shares.tobytes()


def test_robots_without_anything_to_see_and_targets_that_nobody_sees_are_left_out() -> None:
    graph = graph_of_edges([0, 0, 1, 2], [0, 3], [1, 1], 1.0, robots=4, targets=3)
    assert local_shares(graph, 2).shares.tolist() == [1.0, 0.0, 0.0, 1.0]
    assert np.isnan(local_shares(graph, 2).levels).tolist() == [False, True, True, False]
    nobody = graph_of_edges([0], [], [], robots=1, targets=2)
    assert local_shares(nobody, 2).shares.tolist() == [0.0]
    assert exchange(nobody, 2).shares.tolist() == [0.0]


def test_values_are_not_monotone_in_the_height_which_is_why_several_can_be_run() -> None:
    found = {h: value(S1, local_shares(S1, h, eps=1e-6).shares) for h in (2, 10, 30)}
    assert found[2] < found[10] > found[30]


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"h": 0}, "h must be"), ({"h": 2.0}, "h must be"), ({"h": True}, "h must be"), ({"h": 1001}, "h must be"),
        ({"eps": 0.0}, "eps must be"), ({"eps": -0.1}, "eps must be"), ({"eps": 1.5}, "eps must be"), ({"eps": math.nan}, "eps must be"),
        ({"eps": "small"}, "eps must be"), ({"step": 0}, "step must be"), ({"step": math.inf}, "step must be"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("run", [local_shares, exchange])
def test_options_out_of_range_are_refused(run, options: dict[str, object], named: str) -> None:
    with pytest.raises(UsageError, match=named):
        run(S1, **{"h": 2, **options})


@pytest.mark.parametrize(("option", "choices"), [("search", "secant or step"), ("smoothing", "layers or ball")])
@pytest.mark.parametrize("run", [local_shares, exchange])
def test_unknown_choices_are_refused(run, option: str, choices: str) -> None:
    with pytest.raises(UsageError, match=f"{option} must be {choices}", check=coded("unknown-name")):
        run(S1, 2, **{option: "none"})


def test_a_step_that_doubles_cannot_count_is_refused() -> None:
    with pytest.raises(UsageError, check=coded("out-of-range")):
        local_shares(S1, 2, search="step", step=1e-300)


# -- families on which the guarantee is tight ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("robots", "h", "worst"),
    [
        ([[{1: 1, 2: 1}, {1: 1}]], 1, F(1, 2)), ([[{1: 1, 2: 1}, {1: 1}]], 2, F(3, 4)), ([[{1: 1, 2: 1}, {1: 1}]], 3, F(5, 6)),
        ([[{1: 1, 2: 1}, {1: 1}]], 4, F(7, 8)), ([[{1: 1, 2: 1}, {1: 1}]], 5, F(9, 10)), ([[{3: 1}], [{1: 1, 2: 1}, {3: 1}]], 2, F(2, 3)),
        ([[{1: 1}], [{0: 1}, {1: 1}]], 2, F(2, 3)),
    ],
)  # fmt: skip
def test_tiny_cases_attain_the_guarantee(robots: Robots, h: int, worst: F) -> None:
    exact = ExactLocal(robots, h)
    assert exact.value(exact.shares(exact.largest_levels())) == worst
    graph = graph_of(robots)
    assert value(graph, local_shares(graph, h, eps=1e-6, normalise=False).shares) == pytest.approx(float(worst), abs=1e-6)
    bound = F(exact.delta_r) * (1 - F(1, exact.delta_t)) * (1 + F(1, h))
    assert 1 / worst <= bound
    if h == 1 or len(robots) == 2:
        assert 1 / worst == bound


@pytest.mark.parametrize(
    ("m", "depth", "robots", "best", "values"),
    [
        (3, 4, 93, 2.021739, {1: 1.5, 2: 1.5, 3: 1.5214, 4: 1.6357, 6: 1.6843}),
        (3, 8, 1533, 2.001305, {1: 1.5, 2: 1.5, 3: 1.5, 4: 1.5, 6: 1.5134}),
        (4, 6, 4372, 3.000686, {1: 2.0, 2: 2.0, 3: 2.0, 4: 2.0082, 6: 2.1423}),
    ],
)
def test_regular_trees_approach_the_limit_of_all_local_algorithms(
    m: int, depth: int, robots: int, best: float, values: dict[int, float]
) -> None:
    graph = regular_tree(m, depth)
    assert graph.num_robots == robots
    assert graph.num_robots / graph.num_targets == pytest.approx(best, abs=1e-6)
    for h, expected in values.items():
        found = value(graph, local_shares(graph, h, eps=1e-4).shares)
        assert found == pytest.approx(expected, abs=1.5e-4)
        assert best / found <= 2 * (1 - 1 / m) * (1 + 1 / h) * (1 + 1e-4) + 1e-6


@pytest.mark.parametrize("h", [1, 2, 3, 5, 10])
def test_a_cycle_is_covered_evenly(h: int) -> None:
    graph = cycle(12)
    assert value(graph, local_shares(graph, h).shares) == pytest.approx(1.0, abs=1e-9)
