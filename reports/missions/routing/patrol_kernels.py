"""The least sum of longest waits of a patrol among a few fixed places, by labels that no other dominates."""

from __future__ import annotations

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
def _longer(array):  # type: ignore[no-untyped-def]
    grown = np.zeros((2 * len(array), array.shape[1]), np.int64)
    for row in range(len(array)):
        for column in range(array.shape[1]):
            grown[row, column] = array[row, column]
    return grown


@kernel("(i8[:,::1], i8[::1], i8[::1], i8, i8)")
def least_worst_waits(times, waits, worst, horizon, most):  # type: ignore[no-untyped-def]
    """The least sum of the longest waits after ``horizon`` steps, and the places to visit in turn; one that follows itself is kept for a step.

    ``times`` of shape (places + 1, places) are steps between places, 1 on the diagonal, and from the start in the last row; ``waits`` and
    ``worst`` those of each place so far. Returns the sum, or -1 where more than ``most`` labels would be needed, and the visits.
    """
    count = len(waits)
    waited, longest = np.zeros((1024, count), np.int64), np.zeros((1024, count), np.int64)
    facts = np.zeros((1024, 4), np.int64)  # place, label before it, next label of its time, whether it is dominated
    heads, tails = np.full(horizon + 1, -1, np.int64), np.full(horizon + 1, -1, np.int64)
    used, best, found = 1, 0, 0
    for place in range(count):
        waited[0, place], longest[0, place] = waits[place], worst[place]
        best += max(worst[place], waits[place] + horizon)
    facts[0, 0], facts[0, 1], facts[0, 2] = count, -1, -1
    heads[0] = tails[0] = 0
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
                    least += _at_least(place, left, other, times, wait, worse)
                if least >= best:
                    continue
                chain = heads[time + takes]
                while chain >= 0 and not (
                    facts[chain, 0] == place and _dominates(chain, used, place, left, times, waited, longest)
                ):
                    if facts[chain, 0] == place and _dominates(used, chain, place, left, times, waited, longest):
                        facts[chain, 3] = 1
                    chain = facts[chain, 2]
                if chain >= 0:
                    continue
                if used > most:
                    return -1, np.zeros(0, np.int64)
                facts[used, 0], facts[used, 1], facts[used, 2], facts[used, 3] = place, label, -1, 0
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
