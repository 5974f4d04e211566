"""Programs of packing and covering rows in general, max-min and min-max: a restarted primal-dual method, anytime on both sides."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from .....formulations.evidence import Evidence
from .....formulations.sata.balls import Floats
from .....formulations.sata.max_min_lp import MaxMinLP, far_apart
from .....formulations.stop import Flag, Stop
from ....backend import Control, Options, RawResult
from .restarts import ROUND, Restarts, inverse, length
from .threads import Threads

_EPS = float(np.finfo(np.float64).eps)


class PackingCovering:
    """Variables and prices of a program of packing and covering rows, their steps, and the best that they have come to.

    The primal-dual hybrid gradient method on ``max over x >= 0, min over y, z >= 0 with sum y = 1: y'C x - z'(A x - 1)``, with the
    diagonal preconditioners of Pock and Chambolle (2011), reflected Halpern steps (Lu and Yang 2024), and restarts that weigh the steps
    of the two sides anew (Applegate et al. 2021). ``answer`` is feasible and worth ``value``, ``prices`` prove ``bound``; both are the
    best so far. ``news(game, what)`` is called with ``answer`` or ``bound`` when there is a better one. A min-max program is the same one:
    covering by 1 what is covered by ``value`` takes 1 / ``value`` of the most that is packed; see ``objective`` and ``own``.
    docs/saddle.md#several-packing-rows-a-variable.

    Raises
    ------
    UnsupportedError
        If coefficients are so far apart that no double holds their quotients.
    """

    def __init__(
        self, problem: MaxMinLP, start: Floats | None = None, news: Callable[[PackingCovering, str], Any] = lambda game, what: None,
        threads: int = 1,
    ) -> None:  # fmt: skip
        self._packing, self._news, self._least = problem.packing.rows, news, problem.sense == "min"
        self._lay_out(problem)
        self._threads = Threads(threads, 2.0 * len(self._rows[1]))
        self._between = np.empty(len(self._columns[0]) - 1), np.empty(len(self._rows[0]) - 1)
        x = self._even if start is None else start * self._inverse_scale
        prices = np.concatenate([np.full(k, 1.0 / k) for k in (self._packing, problem.covering.rows)])
        self._level = np.zeros(1)
        far, wide = length(x, inverse(self._steps[0])), length(prices, inverse(self._steps[1]))
        self._restarts = Restarts(x, prices, self._steps, far / (wide or 1.0))
        self.value, self.bound, self.answer, self.prices = -math.inf, math.inf, x, prices
        self._look()

    def _lay_out(self, problem: MaxMinLP) -> None:
        """Columns scaled to a largest packing coefficient of 1, covering rows to values near 1; variables that cover nothing left out."""
        from scipy.sparse import diags_array, vstack

        a, c = problem.packing.scipy, problem.covering.scipy
        largest = np.where(np.bincount(c.indices, minlength=c.shape[1]) > 0, a.max(axis=0).toarray().ravel(), 0.0)
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            self._scale, self._inverse_scale = inverse(largest), largest
            a, c = a @ diags_array(self._scale), c @ diags_array(self._scale)
            a.eliminate_zeros()
            self._keep(vstack([a, -c], format="csr"))
            self._even, value = self._scaled_down(np.where(largest > 0.0, 1.0, 0.0))
            self.unit = math.ldexp(1.0, math.frexp(value)[1]) if 0.0 < value < math.inf else 0.0
            c = c * inverse(np.array([self.unit]))[0]
        if not (np.isfinite(self._scale).all() and np.isfinite(c.data).all() and (c.data > 0.0).all()):
            raise far_apart("saddle", problem)
        matrix = vstack([a, -c], format="csr")
        self._keep(matrix)
        short, long = (inverse(np.asarray(abs(matrix).sum(axis=k), dtype=np.float64).ravel()) for k in (0, 1))
        self._steps = short, long

    def _keep(self, matrix: Any) -> None:
        by_column = matrix.tocsc()
        self._rows = matrix.indptr, matrix.indices, matrix.data
        self._columns = by_column.indptr, by_column.indices, by_column.data

    def run(self, stop: Stop, gap: float, most: float = math.inf) -> None:
        """Step until value and bound are within the relative ``gap``, ``stop`` is reached, or ``most`` steps are made."""
        game = self._restarts
        while not self.closed(gap) and game.steps < most and not stop.reached():
            made = self._make(stop.flag, int(min(ROUND, most - game.steps)))
            if made:
                game.note(made)
                self._look()
                game.look()

    def _make(self, flag: Flag, count: int) -> int:
        """``count`` steps, or fewer; returns how many."""
        from .packing_covering_kernels import move_prices, move_variables, steps
        from .sums_kernels import multiply

        game, threads, (reflected, load) = self._restarts, self._threads, self._between
        (short, long), (x, prices), (next_x, next_prices), (x_anchor, price_anchor) = game.lengths, game.point, game.ahead, game.anchor
        if threads.count == 1:
            given = short, long, x, prices, next_x, next_prices, x_anchor, price_anchor, self._level, reflected, load
            return int(steps(flag, *self._rows, *self._columns, self._packing, *given, game.since, count))
        columns, rows = threads.cut(self._columns[0]), threads.cut(self._rows[0])
        for made in range(count):
            if flag[0]:
                return made
            kept = (game.since + made + 1.0) / (game.since + made + 2.0)
            threads.share(move_variables, columns, *self._columns, short, prices, x, next_x, x_anchor, reflected, kept)
            threads.share(multiply, rows, *self._rows, reflected, load)
            move_prices(self._packing, long, load, prices, next_prices, price_anchor, self._level, kept)
        return count

    @property
    def steps(self) -> int:
        return self._restarts.steps

    @property
    def restarts(self) -> int:
        return self._restarts.count

    def closed(self, gap: float) -> bool:
        """Whether value and bound are within the relative ``gap``."""
        return self.value >= self.bound / (1.0 + gap)

    @property
    def own(self) -> Floats:
        """The answer in the problem's own variables."""
        return np.asarray(self.answer * self._scale) / (self.value if self._least else 1.0)

    @property
    def objective(self) -> tuple[float, float]:
        """Value and bound of the problem."""
        return (1.0 / self.value, (1.0 - 4.0 * _EPS) / self.bound) if self._least else (self.value, self.bound)

    def evidence(self) -> Evidence:
        """Evidence of the best bound."""
        data = {"covering": self.prices[self._packing :].tolist(), "packing": self.prices[: self._packing].tolist()}
        return Evidence("packing-covering-duals", "prices of packing and covering rows", self.objective[1], data)

    def _look(self) -> None:
        """Make the last plain step feasible on both sides, and keep what is better than before."""
        from .packing_covering_kernels import pay_for_all

        x, value = self._scaled_down(self._restarts.ahead[0].copy())
        if value * self.unit > self.value:
            self.answer, self.value = x, value * self.unit
            self._news(self, "answer")
        (starts, columns, _), prices = self._rows, self._restarts.ahead[1].copy()
        bound = pay_for_all(starts, columns, *self._columns, self._packing, prices) * self.unit
        bound *= 1.0 + (int(np.diff(self._columns[0]).max(initial=0)) + 16) * _EPS  # the checker rounds upwards
        if bound < self.bound:
            self.prices, self.bound = prices, bound
            self._news(self, "bound")

    def _scaled_down(self, x: Floats) -> tuple[Floats, float]:
        """``x``, divided in place until all packing rows are kept, and its least coverage."""
        from .packing_covering_kernels import scale_down

        return x, scale_down(*self._rows, *self._columns[:2], self._packing, x)


def search_rows(problem: MaxMinLP, options: Options, control: Control, least_gap: float) -> RawResult:
    """See ``Engine.run``; ``iterations`` are steps."""
    empty = np.nonzero(np.diff(problem.covering.indptr) == 0)[0]
    if len(empty):
        unseen = np.zeros(problem.covering.rows)
        unseen[empty[0]] = 1.0
        data = {"covering": unseen.tolist(), "packing": [0.0] * problem.packing.rows}
        proof = Evidence("packing-covering-duals", f"covering row {empty[0] + 1}, which holds no variable", 0.0, data)
        answer = np.zeros(problem.num_variables)
        return RawResult("optimal", "none", answer, 0.0, 0.0, message=f"{proof.source}, keeps the value at 0", evidence=(proof,))
    stop = Stop(options.time_limit)
    control.on_stop(stop.ask)
    start = np.zeros(0) if options.start is None else np.maximum(np.asarray(options.start, dtype=np.float64), 0.0)
    usable = start.shape == (problem.num_variables,) and bool(np.isfinite(start).all() and start.any())
    if usable and problem.sense == "min":  # no multiple of it is an answer unless it covers all rows
        usable = bool((problem.covering.scipy @ start > 0.0).all())

    def news(game: PackingCovering, what: str) -> None:
        if what == "answer":
            control.publish(game.own, game.objective[0])
        else:
            control.publish(bound=game.objective[1], evidence=(game.evidence(),))

    game = PackingCovering(problem, start if usable else None, news, options.threads)
    game.run(stop, max(options.gap, least_gap), math.inf if options.iterations is None else options.iterations)
    optimal = game.closed(least_gap)
    statistics: dict[str, Any] = {"steps": game.steps, "restarts": game.restarts}
    if options.start is not None:
        statistics["start"] = "used" if usable else "ignored"
    limit = "none" if optimal else "gap" if game.closed(options.gap) else stop.reached() or "iterations"
    return RawResult(
        "optimal" if optimal else "feasible", limit, game.own, *game.objective, statistics=statistics, evidence=(game.evidence(),),
    )  # fmt: skip
