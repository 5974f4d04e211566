import math

import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import InputError
from waybound.instances.routing.occupancy import RangeSensor, csqmi, mutual_information
from waybound.instances.routing.occupancy_maps import DecayMap, MarkovMap, cell_worth

SENSOR = RangeSensor(0.9, 0.05)
CELLS = np.arange(3)


def watched(map_, flips, steps, every=1):
    """A cell that flips every so many steps, one that is always occupied, and one that nobody sees."""
    rng = np.random.default_rng(1)
    for step in range(steps):
        truth = np.array([(step // flips) % 2 == 1, True, True])
        seen = CELLS[:2] if step % every == 0 else CELLS[:0]
        hits = rng.random(len(seen)) < np.where(truth[seen], SENSOR.hit, SENSOR.false_hit)
        map_.update(seen, hits)
    return map_


def test_rates_of_cells_that_change_are_learnt():
    map_ = watched(MarkovMap(np.full(3, 0.5), SENSOR, seconds=10.0), 20, 2000)
    change = (map_.rates[0, 1] + map_.rates[1, 0]) / 2
    assert change[0] == pytest.approx(1 / 20, rel=0.3)
    assert map_.rates[1, 0, 1] < 0.01 and map_.p[1] > 0.99  # how often it would become occupied cannot be seen
    assert map_.settled[0] == pytest.approx(0.5, abs=0.15)
    assert map_.p[2] == pytest.approx(0.5)
    assert ((map_.rates >= 0) & (map_.rates <= 1)).all()


def test_transitions_are_counted_in_a_window():
    map_ = watched(MarkovMap(np.full(3, 0.5), SENSOR, seconds=10.0, window=300.0), 20, 100)
    assert map_._counts.sum(axis=0).tolist() == [30, 30, 0]
    believed = watched(MarkovMap(np.full(3, 0.5), SENSOR, seconds=10.0, window=300.0, counted="believed"), 20, 100)
    assert believed._counts.sum(axis=0).tolist() == [30, 30, 30]
    assert map_.chi_square()[2] > map_.chi_square()[0]  # what is not looked at fits worst
    assert np.ptp(MarkovMap(np.full(3, 0.5), SENSOR, seconds=10.0).chi_square()) == 0.0


def test_worth_is_information_and_misfit():
    map_ = watched(MarkovMap(np.full(3, 0.5), SENSOR, seconds=10.0), 20, 50)
    joint = SENSOR.joint(map_.p)
    assert cell_worth(map_, "csqmi", 0.0) == pytest.approx(csqmi(joint))
    assert cell_worth(map_, "mutual-information", 100.0) == pytest.approx(mutual_information(joint) + 100.0 * map_.chi_square())
    assert cell_worth(map_, "chi-square", 7.0) == pytest.approx(map_.chi_square())


def test_periods_of_change_are_learnt_and_those_of_static_cells_grow():
    map_ = watched(DecayMap(np.full(3, 0.5), SENSOR, seconds=10.0, period=100.0), 30, 600)
    assert map_.period[0] == pytest.approx(300.0, rel=0.25)
    assert map_.period[1] > 2 * map_.period[0] and map_.period[2] == 100.0


def test_as_printed_a_change_is_measured_from_the_reading_before():
    own, printed = (watched(DecayMap(np.full(3, 0.5), SENSOR, seconds=10.0, period=100.0, since=way), 30, 600) for way in ("shift", "last"))
    assert printed.period[0] < own.period[0] - 25.0


def test_without_learning_nothing_decays():
    map_ = watched(DecayMap(np.full(3, 0.5), SENSOR, seconds=10.0, learning=False), 50, 20)
    before = map_.p.copy()
    for _ in range(50):
        map_.update(CELLS[:0], np.zeros(0, dtype=bool))
    assert map_.p == pytest.approx(before)
    assert map_.closes(0.3)[0] == math.inf and map_.closes(0.3)[1] == -math.inf


def test_free_cells_close_when_they_become_unknown():
    map_ = DecayMap(np.full(3, 0.5), SENSOR, seconds=10.0, period=100.0)
    for _ in range(3):
        map_.update(CELLS[:1], np.array([False]))
    closes = map_.closes(0.3)
    assert 0 < closes[0] <= 100.0 and closes[1] == -math.inf
    for _ in range(math.ceil(closes[0] / 10.0)):
        map_.update(CELLS[:0], np.zeros(0, dtype=bool))
    assert map_.p[0] >= 0.3 and map_.closes(0.3)[0] <= 1e-9
    markov = MarkovMap(np.array([0.1, 0.3, 0.9]), SENSOR, seconds=10.0)
    assert markov.closes(0.3).tolist() == [math.inf, -math.inf, -math.inf]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: MarkovMap(np.full(3, 0.5), SENSOR, seconds=10.0, rate=0.0), "rates of change"),
        (lambda: MarkovMap(np.full(3, 0.5), SENSOR, seconds=10.0, forgetting=1.0), "rates of change"),
        (lambda: MarkovMap(np.full(3, 0.5), SENSOR, seconds=10.0, window=5.0), "the window have a step"),
        (lambda: DecayMap(np.full(3, 0.5), SENSOR, seconds=10.0, noise=0.0), "variances of periods"),
        (lambda: DecayMap(np.full(3, 0.5), SENSOR, seconds=10.0, surest=0.6), "confidence would grow"),
    ],
)
def test_what_cannot_be_learnt_is_refused(make, message):
    with pytest.raises(InputError, match=message, check=coded("out-of-range")):
        make()
