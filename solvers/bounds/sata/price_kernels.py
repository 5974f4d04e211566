"""Compiled loop of the primal-dual method for prices of items. Imports numba: import it inside functions only."""

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked


@inner
def _price(p, step, first, last, worths, chosen):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The q >= 0 of least q + sum_e x_e max(0, c_e - q) + (q - p)^2 / (2 step), weights c in descending order."""
    q, above = p - step, 0.0
    for k in range(first, last):
        if q >= worths[k]:
            break
        above += chosen[k]
        q = p - step * (1.0 - above)
        if q >= worths[k]:  # the slope changes its sign at the weight itself
            q = worths[k]
            break
    return max(q, 0.0)


@inner
def _threshold(first, last, order, aims, limit, theta):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The t >= 0 at which the aims of a group's elements, less t and cut to [0, 1], sum to its limit; 0 where they do no more anyway.

    Newton's method from ``theta``, and bisection where it leaves what is known to hold the root.
    """
    low, high, total = 0.0, 0.0, 0.0
    for k in range(first, last):
        total += min(max(aims[order[k]], 0.0), 1.0)
        high = max(high, aims[order[k]])
    if total <= limit:
        return 0.0
    t = theta if 0.0 < theta < high else 0.0
    for _ in range(100):
        total, free = 0.0, 0
        for k in range(first, last):
            left = aims[order[k]] - t
            if left >= 1.0:
                total += 1.0
            elif left > 0.0:
                total += left
                free += 1
        if abs(total - limit) <= 1e-12 * limit:
            break
        if total > limit:
            low = t
        else:
            high = t
        ahead = t + (total - limit) / free if free > 0 else low
        if not low < ahead < high:
            ahead = 0.5 * (low + high)
        if ahead == t:
            break
        t = ahead
    return t


@kernel(
    "i8(i8[::1], i4[::1], i4[::1], f8[::1], i4[::1], i4[::1], f8[::1], i4[::1], i4[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], "
    "f8[::1], f8[::1], f8[::1], f8[::1], i8, i8)"
)
def steps(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, starts, items, weights, item_starts, elements, falling, first, order, limits, item_step, group_step,
    chosen, prices, worth, mean_chosen, mean_prices, thresholds, done, count,
):  # fmt: skip
    """``count`` steps, fewer where the ``flag`` of a ``Stop`` is set; returns the steps made. Arrays from ``chosen`` on change in place.

    ``starts``, ``items`` and ``weights`` are the CSR form of elements x items, ``item_starts``, ``elements`` and ``falling`` that of
    items x elements, by falling weights. The elements of a group are ``order[first[g]]`` to ``order[first[g + 1] - 1]``. ``worth`` holds
    that of the elements at the prices before; the means are over ``done`` steps.
    """
    aims = np.empty(len(chosen))
    at_edge = np.empty(len(falling))
    for step in range(done, done + count):
        if asked(flag):
            return step - done
        part = 1.0 / (step + 1.0)
        for k in range(len(falling)):
            at_edge[k] = chosen[elements[k]]
        for j in range(len(prices)):
            prices[j] = _price(prices[j], item_step[j], item_starts[j], item_starts[j + 1], falling, at_edge)
            mean_prices[j] += part * (prices[j] - mean_prices[j])
        for g in range(len(limits)):
            for k in range(first[g], first[g + 1]):
                e = order[k]
                total = 0.0
                for a in range(starts[e], starts[e + 1]):
                    total += max(weights[a] - prices[items[a]], 0.0)
                aims[e] = chosen[e] + group_step[g] * (2.0 * total - worth[e])
                worth[e] = total
            thresholds[g] = _threshold(first[g], first[g + 1], order, aims, limits[g], thresholds[g])
            for k in range(first[g], first[g + 1]):
                e = order[k]
                chosen[e] = min(max(aims[e] - thresholds[g], 0.0), 1.0)
                mean_chosen[e] += part * (chosen[e] - mean_chosen[e])
    return count
