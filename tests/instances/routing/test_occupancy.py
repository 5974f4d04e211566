import heapq
import math

import numpy as np
import pytest
from coded import coded
from hypothesis import example, given, strategies as st

from waybound.instances.errors import InputError
from waybound.instances.routing import occupancy as o

SENSOR = o.RangeSensor(0.9, 0.05)


def test_predictions_tend_to_the_stationary_probability():
    p, found = 0.5, []
    for _ in range(5):
        p = o.predicted(p, 0.1, 0.2)
        found.append(p)
    assert found == pytest.approx([0.45, 0.415, 0.3905, 0.37335, 0.361345], abs=1e-12)
    assert o.stationary(0.1, 0.2) == pytest.approx(1 / 3)


@pytest.mark.parametrize(("hit", "p"), [(True, 0.936416), (False, 0.079295)])
def test_a_reading_after_a_prediction(hit, p):
    assert o.corrected(0.45, SENSOR.likelihood(np.array([hit]))[:, 0]) == pytest.approx(p, abs=1e-6)


@pytest.mark.parametrize(("p", "false_hit", "bits"), [(0.45, 0.05, 0.618247), (0.5, 0.1, 0.531004)])
def test_mutual_information(p, false_hit, bits):
    assert o.mutual_information(o.RangeSensor(0.9, false_hit).joint(p))[0] == pytest.approx(bits, abs=1e-6)


def test_quadratic_information():
    assert o.csqmi(o.RangeSensor(0.9, 0.1).joint(0.5))[0] == pytest.approx(0.713696, abs=1e-6)
    assert o.csqmi(o.RangeSensor(0.9, 0.1).joint(0.5))[0] * math.log(2) == pytest.approx(0.494696, abs=1e-6)


@pytest.mark.parametrize(
    ("p", "hit", "false_hit", "once", "twice"), [(0.25, 0.99, 0.4, 0.148647, 0.353162), (0.1, 0.9, 0.01, 0.027481, 0.027235)]
)
def test_quadratic_information_of_two_readings_is_neither_submodular_nor_monotone(p, hit, false_hit, once, twice):
    one = o.RangeSensor(hit, false_hit).joint(p)[..., 0]
    of_state = one / one.sum(axis=1, keepdims=True)
    two = one.sum(axis=1)[:, None, None] * of_state[:, :, None] * of_state[:, None, :]
    values = [float(o.csqmi(joint.reshape(2, -1))) * math.log(2) for joint in (one, two)]
    assert values == pytest.approx([once, twice], abs=1e-6)
    informed = [float(o.mutual_information(joint.reshape(2, -1))) for joint in (one, two)]
    assert informed[0] <= informed[1] <= 2 * informed[0]


@given(st.floats(0, 1), st.floats(0.01, 0.49), st.floats(0.5, 0.99))
def test_information_is_that_of_the_entropies(p, false_hit, hit):
    hits = p * hit + (1 - p) * false_hit
    expected = o.entropy(hits) - p * o.entropy(hit) - (1 - p) * o.entropy(false_hit)
    assert o.mutual_information(o.RangeSensor(hit, false_hit).joint(p))[0] == pytest.approx(float(expected), abs=1e-9)


def test_misfit_of_counts():
    found = o.chi_square(np.array([[10.0], [2.0], [2.0], [6.0]]), np.array([1 / 3]), np.array([0.1]), np.array([0.2]), 20)
    assert found[0] == pytest.approx(1.083333, abs=1e-6)
    assert np.isfinite(o.chi_square(np.ones((4, 1)), np.zeros(1), np.zeros(1), np.ones(1), 4)).all()


def test_divergence_and_entropy():
    assert o.divergence(np.array([0.8, 0.8]), np.array([True, False])) == pytest.approx([0.321928, 2.321928], abs=1e-6)
    assert o.entropy([0.0, 0.5, 1.0]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)


def test_confidence_decays_to_the_threshold_in_a_period():
    rate = float(o.decay_rate(60.0, 0.97, 0.7))
    assert rate == pytest.approx(0.0235269, abs=1e-7)
    assert o.probability(o.logit(0.97) * math.exp(-rate * 60)) == pytest.approx(0.7)
    assert float(o.decay_rate(60.0, 0.03, 0.3)) == pytest.approx(rate)
    assert o.unknown_at(o.logit(0.05), rate, 10.0, 0.3) == pytest.approx(62.9446, abs=1e-4)
    assert o.unknown_at(o.logit([0.05, 0.4]), 0.0, 10.0, 0.3).tolist() == [math.inf, -math.inf]


@pytest.mark.parametrize(
    "how", [(60.0, 0.6, 0.7), (60.0, 0.4, 0.3), (-1.0, 0.97, 0.7), (60.0, 1.0, 0.7), (60.0, 0.97, 0.5), (60.0, 0.3, 0.7)]
)
def test_confidence_that_would_grow_is_refused(how):
    with pytest.raises(InputError, match="confidence would grow", check=coded("out-of-range")):
        o.decay_rate(*how)


def test_a_period_is_measured():
    assert o.updated_period(60.0, 25.0, 80.0, 1.0, 100.0) == pytest.approx((64.126984, 20.634921), abs=1e-6)


@pytest.mark.parametrize(("hit", "false_hit"), [(0.5, 0.5), (0.2, 0.4), (1.0, 0.1), (0.9, 0.0), (math.nan, 0.1), (1.5, 0.1)])
def test_sensors_that_tell_nothing_or_are_no_probabilities_are_refused(hit, false_hit):
    with pytest.raises(InputError, match="more probable on occupied", check=coded("out-of-range")):
        o.RangeSensor(hit, false_hit)


@given(st.integers(0, 10**6))
def test_online_em_filters_as_bayes_does_and_keeps_distributions(seed):
    rng = np.random.default_rng(seed)
    p, rate = rng.random(3), rng.uniform(0.01, 0.5, (2, 3))
    rates = np.array([[1 - rate[0], rate[0]], [rate[1], 1 - rate[1]]])
    q = np.stack([1 - p, p])
    flows = 0.5 * rates[:, :, None] * q
    likelihood = SENSOR.likelihood(rng.random(3) < 0.5)
    now, flows, learnt = o.online_em(q, flows, rates, likelihood, 0.1)
    assert now[1] == pytest.approx(o.corrected(o.predicted(p, *rate), likelihood), abs=1e-12)
    assert flows.sum(axis=(0, 1, 2)) == pytest.approx(np.ones(3)) and learnt.sum(axis=1) == pytest.approx(np.ones((2, 3)))
    assert flows.sum(axis=(0, 1)) == pytest.approx(now)


@pytest.mark.parametrize(("beam", "visible"), [([0.2, 0.5, 0.9], [1.0, 0.8, 0.4])])
def test_visibility_along_a_beam(beam, visible):
    beams = o.Beams(np.array([[[0, 0], [0, 1], [0, 2]]]), np.ones((1, 3), dtype=bool))
    found = beams.visibility(np.array([beam]), np.array([[0, 0]]))
    assert found[0] == pytest.approx(visible)
    worth = np.array([1.0, 2.0, 3.0])
    assert found[0] @ worth == pytest.approx(3.8)
    assert np.maximum(found[0], [0.5, 1.0, 0.1]) @ worth == pytest.approx(4.2)


@example(1.0, 180.0, 2)  # through corners
@given(st.floats(1, 8), st.floats(10, 360), st.integers(1, 20))
def test_beams_pass_cells_that_touch_and_lie_within_reach(reach, field, count):
    beams = o.Beams.of(reach, field, count)
    assert len(beams.steps) == count + 1 and beams.steps[0][beams.there[0]].tolist() == [[0, 0]]
    for cells, there in zip(beams.steps[1:], beams.there[1:], strict=True):
        own = np.vstack([[[0, 0]], cells[there]])
        assert (np.abs(np.diff(own, axis=0)).max(axis=1, initial=1) == 1).all() and len({tuple(c) for c in own.tolist()}) == len(own)
        assert (np.hypot(*own.T) <= reach + math.sqrt(0.5) + 1e-9).all()


def test_what_is_occupied_is_seen_and_hides_what_is_behind():
    beams, truth = o.Beams.of(3.0, 360.0, 64), np.zeros((7, 7))
    truth[3, 4] = 1.0
    _, cells, _ = beams.passed(truth, np.array([[3, 3]]))
    assert 3 * 7 + 4 in cells and 3 * 7 + 5 not in cells and 3 * 7 + 1 in cells


GRID = np.full((3, 5), math.inf)


@pytest.mark.parametrize(
    ("closing", "steps"),
    [({(1, 2): 2.5}, 4), ({(1, 2): 2.0}, 6), ({(1, 2): 1.5}, 6), ({(0, 2): 2.5, (2, 2): -math.inf, (1, 2): 1.5}, -1)],
)
def test_ways_through_closing_cells(closing, steps):
    closes = GRID.copy()
    for cell, moment in closing.items():
        closes[cell] = moment
    found = o.ways(closes, [(1, 0)], 0.0, 1.0)[0]
    assert found[1, 4] == steps
    path = o.way(found, (1, 4))
    assert len(path) == max(steps, 0) and (not path or path[-1] == (1, 4))


def test_the_latest_start_of_a_way():
    assert o.latest_start([20.0, 7.5, 9.0, math.inf], 1.0) == 5.5
    assert o.latest_start([], 1.0) == math.inf


@given(st.integers(0, 10**6), st.floats(0, 3), st.floats(0.5, 2))
def test_ways_are_those_of_dijkstra(seed, begin, step):
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(1, 7, 2))
    closes = np.where(rng.random(shape) < 0.5, np.inf, rng.uniform(-2, 8, shape))
    start = tuple(int(rng.integers(n)) for n in shape)
    known, queue = {}, [(0, start)]
    while queue:
        steps, cell = heapq.heappop(queue)
        if cell in known:
            continue
        known[cell] = steps
        for side in o.SIDES:
            near = (cell[0] + side[0], cell[1] + side[1])
            if 0 <= near[0] < shape[0] and 0 <= near[1] < shape[1] and begin + (steps + 1) * step < closes[near]:
                heapq.heappush(queue, (steps + 1, near))
    found = o.ways(closes, [start], begin, step)[0]
    assert {cell: int(found[cell]) for cell in np.ndindex(shape) if found[cell] >= 0} == known
    for cell in known:
        path = [start, *o.way(found, cell)]
        assert path[-1] == cell and len(path) == known[cell] + 1
        assert all(begin + k * step < closes[c] for k, c in enumerate(path) if k)
