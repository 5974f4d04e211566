"""Compiled loops of the cleaning. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from ....formulations.kernels import kernel


@kernel("(read(i4[::1]), read(i4[::1]), read(i4[::1]), read(f8[::1]), i4[::1])")
def survey(robot_of_action, starts, targets, weights, viewers):  # type: ignore[no-untyped-def]
    """Count the actions that see each target.

    Returns whether robots ascend, how many actions see something, how many targets have one viewer, the most viewers of a target,
    and the least and the largest weight.
    """
    ascending, live, lightest, heaviest = True, 0, np.inf, 0.0
    for v in range(len(robot_of_action)):
        if v > 0 and robot_of_action[v] < robot_of_action[v - 1]:
            ascending = False
        if starts[v + 1] > starts[v]:
            live += 1
    for e in range(len(targets)):
        viewers[targets[e]] += 1
        lightest, heaviest = min(lightest, weights[e]), max(heaviest, weights[e])
    most, private = 0, 0
    for k in range(len(viewers)):
        most = max(most, viewers[k])
        if viewers[k] == 1:
            private += 1
    return ascending, live, private, most, lightest, heaviest


@kernel("(read(i4[::1]), read(i4[::1]), i8)")
def by_robot(robot_of_action, starts, num_robots):  # type: ignore[no-untyped-def]
    """Actions that see something, robot after robot, in ascending order within a robot."""
    place = np.zeros(num_robots + 1, dtype=np.int32)
    for v in range(len(robot_of_action)):
        if starts[v + 1] > starts[v]:
            place[robot_of_action[v] + 1] += 1
    for i in range(num_robots):
        place[i + 1] += place[i]
    order = np.empty(place[num_robots], dtype=np.int32)
    for v in range(len(robot_of_action)):
        if starts[v + 1] > starts[v]:
            order[place[robot_of_action[v]]] = v
            place[robot_of_action[v]] += 1
    return order


@kernel("(read(i4[::1]), i4[::1], i4[::1])")
def group(robot_of_action, order, first):  # type: ignore[no-untyped-def]
    """Starts of the robots in ``order``; returns how many robots there are, and the most actions of one."""
    robots, most = 0, 0
    for p in range(len(order)):
        if p == 0 or robot_of_action[order[p]] != robot_of_action[order[p - 1]]:
            first[robots] = p
            robots += 1
        most = max(most, p + 1 - first[robots - 1])
    first[robots] = len(order)
    return robots, most


@kernel("(i4[::1], read(i4[::1]), read(i4[::1]), read(f8[::1]), i4[::1], i4[::1], i4[::1], f8[::1], f8[::1])")
def condense(order, starts, targets, weights, viewers, new_starts, new_targets, new_weights, private):  # type: ignore[no-untyped-def]
    """Copy the edges of the actions in ``order``; targets of one viewer become ``private``, their least weight an action."""
    size = 0
    for p in range(len(order)):
        v = order[p]
        new_starts[p] = size
        for e in range(starts[v], starts[v + 1]):
            if viewers[targets[e]] > 1:
                new_targets[size] = targets[e]
                new_weights[size] = weights[e]
                size += 1
            elif private[p] == 0.0 or weights[e] < private[p]:
                private[p] = weights[e]
    new_starts[len(order)] = size
