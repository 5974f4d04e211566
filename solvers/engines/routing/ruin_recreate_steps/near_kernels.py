"""The customers next to each site, compiled. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import kernel


@kernel(
    "(i8[:, ::1], i8[:, ::1], i8[::1], i8[::1], i8[::1], i8[::1], b1[::1], f8, i8, i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[::1], f8[::1])",
    _nrt=False,
)
def nearest(on, goes, ready, due, service, latest, visited, weight, most, near, reach, drive, quickest, far):  # type: ignore[no-untyped-def]
    """Fill in ``near``, ``reach``, ``drive`` and ``quickest``, as ``arrays`` says what they are.

    ``latest`` is when somebody who begins as late as possible is served at a site, ``visited`` are the customers; no move is as long as
    ``most``. ``far`` is room for the work.
    """
    sites, many = near.shape
    for i in range(sites):
        held, begins = 0, ready[i] + service[i]
        shortest, soonest, shortest_to = most, most, most
        for j in range(sites):
            if j == i:
                continue
            onward, back, drives, drives_back = on[i, j], on[j, i], goes[i, j], goes[j, i]
            shortest, soonest, shortest_to = min(shortest, onward), min(soonest, drives), min(shortest_to, back)
            if not visited[j]:
                continue
            away = np.float64(most)
            if begins + drives <= due[j]:
                away = min(away, onward + weight * max(ready[j] - latest[i] - drives, 0))
            if ready[j] + service[j] + drives_back <= due[i]:
                away = min(away, back + weight * max(ready[i] - latest[j] - drives_back, 0))
            if away >= most or (held == many and away >= far[many - 1]):
                continue
            place = held if held < many else many - 1
            held = min(many, held + 1)
            while place > 0 and far[place - 1] > away:
                far[place], near[i, place] = far[place - 1], near[i, place - 1]
                place -= 1
            far[place], near[i, place] = away, j
        quickest[i] = soonest
        for place in range(held):
            j = near[i, place]
            if ready[j] + service[j] + goes[j, i] <= due[i]:
                reach[i, place], drive[i, place] = on[j, i] + shortest, goes[j, i]
            else:
                reach[i, place], drive[i, place] = -1 - on[i, j] - shortest_to, service[i] + goes[i, j]
        for place in range(held, many):
            near[i, place], reach[i, place], drive[i, place] = -1, -1, 0
