"""The least sum of longest waits of a patrol among a few fixed places, by labels that no other dominates."""

import numpy as np

from ....formulations.kernels import inner, kernel


@inner
def _at_least(here, left, place, times, wait, worst):  # type: ignore[no-untyped-def]
    """Longest wait of ``place`` at the end, if it is gone to next, or kept where the aircraft is there."""
    return max(worst, wait + min(left, 1 if place == here else times[here, place]))


@inner
def _dominates(one, other, here, left, times, waits, worst):  # type: ignore[no-untyped-def]
    """Whether label ``one`` ends with no more than ``other`` of the same place and time, whatever follows."""
    for place in range(waits.shape[1]):
        if waits[one, place] > waits[other, place]:
            return False
        mine = _at_least(here, left, place, times, waits[one, place], worst[one, place])
        if mine > _at_least(here, left, place, times, waits[other, place], worst[other, place]):
            return False
    return True


@inner
def _greedy(times, waits, worst, horizon, alpha):  # type: ignore[no-untyped-def]
    """The sum that a patrol ends with which always goes where the wait less ``alpha`` times the steps is largest."""
    here, left, waits, worst = len(waits), horizon, waits.copy(), worst.copy()
    while True:
        to = -1
        for place in range(len(waits)):
            wait = waits[place] - alpha * times[here, place]
            if times[here, place] <= left and (to < 0 or wait > waits[to] - alpha * times[here, to]):
                to = place
        if to < 0 or left == 0:
            break
        takes = max(times[here, to], 1)
        waits += takes
        worst[to], waits[to] = max(worst[to], waits[to]), 0
        here, left = to, left - takes
    total = 0
    for place in range(len(waits)):
        total += max(worst[place], waits[place] + left)
    return total


@inner
def _longer(array):  # type: ignore[no-untyped-def]
    grown = np.zeros((2 * len(array), array.shape[1]), np.int64)
    for row in range(len(array)):
        for column in range(array.shape[1]):
            grown[row, column] = array[row, column]
    return grown


@kernel("(i8[:,::1], i8[::1], i8[::1], i8, i8)")
def least_worst_waits(times, waits, worst, horizon, most):  # type: ignore[no-untyped-def]
    """The least sum of the longest waits after ``horizon`` steps, and the places to visit in turn; one after itself is kept for a step.

    ``times`` of shape (places + 1, places) are steps between places, 1 on the diagonal, and from the start in the last row; ``waits`` and
    ``worst`` those of each place so far. Returns the sum, or -1 where more than ``most`` labels would be needed, and the visits.
    """
    count = len(waits)
    waited, longest = np.zeros((1024, count), np.int64), np.zeros((1024, count), np.int64)
    facts = np.zeros((1024, 5), np.int64)  # place, label before it, next of its time, whether it is dominated, next of its time and place
    heads, tails = np.full(horizon + 1, -1, np.int64), np.full(horizon + 1, -1, np.int64)
    kept = np.full((horizon + 1, count), -1, np.int64)
    used, best, found = 1, 0, 0
    for place in range(count):
        waited[0, place], longest[0, place] = waits[place], worst[place]
        best += max(worst[place], waits[place] + horizon)
    fewest = times.copy()  # by way of others, as the cheapest path is not always the shortest
    for way in range(count):
        for here in range(count + 1):
            for place in range(count):
                fewest[here, place] = min(fewest[here, place], fewest[here, way] + fewest[way, place])
    facts[0, 0], facts[0, 1], facts[0, 2] = count, -1, -1
    heads[0] = tails[0] = 0
    for alpha in (0.0, 0.5, 1.0, 2.0):
        best = min(best, _greedy(times, waits, worst, horizon, alpha) + 1)  # what is as good is still to be found
    for time in range(horizon + 1):
        label = heads[time]
        while label >= 0:
            here = facts[label, 0]
            for place in range(count):
                takes = times[here, place]
                left = horizon - time - takes
                if left < 0 or facts[label, 3] == 1:
                    continue
                if used == len(facts):
                    waited, longest, facts = _longer(waited), _longer(longest), _longer(facts)
                ends, least = 0, 0
                for other in range(count):
                    wait, worse = waited[label, other] + takes, longest[label, other]
                    if other == place:
                        wait, worse = 0, max(worse, wait)
                    waited[used, other], longest[used, other] = wait, worse
                    ends += max(worse, min(left, 1) if other == place else wait + left)
                    least += _at_least(place, left, other, fewest, wait, worse)
                if least >= best:
                    continue
                chain, before = kept[time + takes, place], -1
                while chain >= 0 and not _dominates(chain, used, place, left, fewest, waited, longest):
                    if _dominates(used, chain, place, left, fewest, waited, longest):
                        facts[chain, 3] = 1
                        if before < 0:
                            kept[time + takes, place] = facts[chain, 4]
                        else:
                            facts[before, 4] = facts[chain, 4]
                    else:
                        before = chain
                    chain = facts[chain, 4]
                if chain >= 0:
                    continue
                if used > most:
                    return -1, np.zeros(0, np.int64)
                facts[used, 0], facts[used, 1], facts[used, 2], facts[used, 3] = place, label, -1, 0
                facts[used, 4], kept[time + takes, place] = kept[time + takes, place], used
                if heads[time + takes] < 0:
                    heads[time + takes] = used
                else:
                    facts[tails[time + takes], 2] = used
                tails[time + takes] = used
                if ends < best:
                    best, found = ends, used
                used += 1
            label = facts[label, 2]
    visits = np.zeros(used, np.int64)
    length = 0
    while found > 0:
        visits[length] = facts[found, 0]
        length += 1
        found = facts[found, 1]
    return best, visits[:length][::-1].copy()
