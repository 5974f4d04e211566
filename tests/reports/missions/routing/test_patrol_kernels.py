import numpy as np
from hypothesis import given, strategies as st

from waybound.reports.missions.routing.patrol_kernels import least_worst_waits


def judged(times, waits, worst, horizon, visits):
    """The sum of longest waits after these visits, the last kept to the end; None if they take too long."""
    here, time, waits, worst = len(waits), 0, list(waits), list(worst)
    for place in visits:
        takes = int(times[here, place])
        waits = [wait + takes for wait in waits]
        worst[place], waits[place] = max(worst[place], waits[place]), 0
        here, time = place, time + takes
    left = horizon - time
    ends = [max(w, min(left, 1) if k == here else wait + left) for k, (w, wait) in enumerate(zip(worst, waits, strict=True))]
    return sum(ends) if left >= 0 else None


def least(times, waits, worst, horizon, visits=()):
    own = judged(times, waits, worst, horizon, visits)
    if own is None:
        return float("inf")
    idle = len(visits) > 1 and visits[-1] == visits[-2] and not times[visits[-1], visits[-1]]
    return min([own, *(least(times, waits, worst, horizon, (*visits, place)) for place in range(len(waits)) if not idle)])


def case(seed, count, side):
    rng = np.random.default_rng(seed)
    at = side * rng.random((count + 1, 2))
    apart = np.ceil(np.hypot(*(at[:, None, :] - at[None, :, :]).transpose(2, 0, 1))).astype(np.int64)
    times = np.ascontiguousarray(np.vstack([apart[1:, 1:], apart[:1, 1:]]))
    times[:count][np.eye(count, dtype=bool)] = 1
    waits = rng.integers(0, 8, count)
    return times, waits, waits + rng.integers(0, 5, count)


@given(st.integers(0, 10**6), st.integers(1, 3), st.integers(1, 6), st.integers(0, 9))
def test_no_sequence_of_visits_is_better(seed, count, side, horizon):
    times, waits, worst = case(seed, count, side)
    total, visits = least_worst_waits(times, waits, worst, horizon, 10**6)
    assert total == least(times, waits, worst, horizon)
    assert judged(times, waits, worst, horizon, visits.tolist()) == total


@given(st.integers(0, 10**6), st.integers(2, 3), st.integers(3, 9))
def test_a_way_round_may_be_shorter_than_the_cheapest_path(seed, count, horizon):
    rng = np.random.default_rng(seed)
    times, waits = rng.choice([1, 2, 3, 9], (count + 1, count)), rng.integers(0, 12, count)
    worst = waits + rng.integers(0, 2, count)
    times[:count][np.eye(count, dtype=bool)] = 1
    total, visits = least_worst_waits(times, waits, worst, horizon, 10**6)
    assert total == least(times, waits, worst, horizon) == judged(times, waits, worst, horizon, visits.tolist())


@given(st.integers(0, 10**6), st.integers(2, 5))
def test_more_time_is_never_better_and_faster_flights_never_worse(seed, count):
    times, waits, worst = case(seed, count, 12)
    totals = [least_worst_waits(times, waits, worst, horizon, 10**6)[0] for horizon in (10, 20, 30)]
    assert totals == sorted(totals)
    assert least_worst_waits(np.maximum(times - 1, 1), waits, worst, 30, 10**6)[0] <= totals[-1]


def test_moves_that_take_no_time_see_two_places_at_once():
    times = np.array([[1, 0], [0, 1], [3, 3]])
    assert least_worst_waits(times, np.zeros(2, np.int64), np.zeros(2, np.int64), 9, 10**6)[0] == 6


def test_it_gives_up_beyond_the_labels_that_it_may_make():
    times, waits, worst = case(3, 5, 12)
    assert least_worst_waits(times, waits, worst, 30, 5)[0] == -1
    assert len(least_worst_waits(times, waits, worst, 30, 5)[1]) == 0
