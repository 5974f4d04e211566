"""The bottleneck greedy, compiled: the worst target under a trial action from a tree of minima, not from a pass over all targets."""

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked


@inner
def set_leaf(tree, leaf, value):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Put ``value`` into a leaf of a binary tree of minima (root at 1)."""
    tree[leaf] = value
    at = leaf // 2
    while at >= 1:
        tree[at] = min(tree[2 * at], tree[2 * at + 1])
        at //= 2


@kernel("(i8[::1], i4[::1], i4[::1], read(i4[::1]), read(i4[::1]), read(f8[::1]), i8)")
def best_worst_target(flag, starts, actions, indptr, indices, weights, targets):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """For each robot in turn the action after which the worst target is covered best, the first of equal ones; -1 without actions.

    Returns the actions, and how many robots had their turn before the ``flag`` was set.
    """
    size = 1
    while size < targets:
        size *= 2
    tree = np.full(2 * size, np.inf)
    for j in range(targets):
        tree[size + j] = 0.0
    for at in range(size - 1, 0, -1):
        tree[at] = min(tree[2 * at], tree[2 * at + 1])
    picks = np.full(len(starts) - 1, -1)
    longest = 0
    for a in range(len(indptr) - 1):
        longest = max(longest, indptr[a + 1] - indptr[a])
    before = np.empty(longest)
    for robot in range(len(picks)):
        worst = -1.0
        for k in range(starts[robot], starts[robot + 1]):
            if asked(flag):
                picks[robot] = -1
                return picks, robot
            a = actions[k]
            for p in range(indptr[a], indptr[a + 1]):
                leaf = size + indices[p]
                before[p - indptr[a]] = tree[leaf]
                set_leaf(tree, leaf, tree[leaf] + weights[p])
            if tree[1] > worst:
                picks[robot], worst = a, tree[1]
            for p in range(indptr[a], indptr[a + 1]):  # back to what it was, to the bit
                set_leaf(tree, size + indices[p], before[p - indptr[a]])
        if picks[robot] >= 0:
            for p in range(indptr[picks[robot]], indptr[picks[robot] + 1]):
                leaf = size + indices[p]
                set_leaf(tree, leaf, tree[leaf] + weights[p])
    return picks, len(picks)
