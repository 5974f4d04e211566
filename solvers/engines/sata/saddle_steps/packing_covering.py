"""Max-min programs whose variables stand in several packing rows: a restarted primal-dual method, anytime on both sides."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from .....formulations.evidence import Evidence
from .....formulations.sata.balls import Floats
from .....formulations.stop import Stop
from .....instances.errors import UnsupportedError
from ....backend import Control, Options, RawResult

if TYPE_CHECKING:
    from .....formulations.sata.max_min_lp import MaxMinLP

_EPS = float(np.finfo(np.float64).eps)

ROUND = 40
"""Steps between two looks at value, bound and residual."""

SUFFICIENT, NECESSARY, LONGEST = 0.2, 0.8, 0.36
"""A restart comes once the residual has fallen by the first factor, or by the second and grows again, or after that share of all steps: the
rules of PDLP. The residual is the distance between the point and the plain step beside it."""


class PackingCovering:
    """Variables and prices of a program of packing and covering rows, their steps, and the best that they have come to.

    The primal-dual hybrid gradient method on ``max over x >= 0, min over y, z >= 0 with sum y = 1: y'C x - z'(A x - 1)``, with the
    diagonal preconditioners of Pock and Chambolle (2011), reflected Halpern steps (Lu and Yang 2024), and restarts that weigh the steps
    of the two sides anew (Applegate et al. 2021). ``answer`` is feasible and worth ``value``, ``prices`` prove ``bound``; both are the
    best so far. ``news(game, what)`` is called with ``answer`` or ``bound`` when there is a better one.
    docs/saddle.md#several-packing-rows-a-variable.

    Raises
    ------
    UnsupportedError
        If coefficients are so far apart that no double holds their quotients.
    """

    def __init__(
        self, problem: MaxMinLP, start: Floats | None = None, news: Callable[[PackingCovering, str], Any] = lambda game, what: None
    ) -> None:
        self._packing, self._news = problem.packing.rows, news
        self._lay_out(problem)
        x = self._even if start is None else start * self._inverse_scale
        prices = np.concatenate([np.full(k, 1.0 / k) for k in (self._packing, problem.covering.rows)])
        self._x, self._prices, self._level = x, prices, np.zeros(1)
        self._next, self._anchors = (x.copy(), prices.copy()), (x.copy(), prices.copy())
        self._balance = _length(prices, self._long) / (_length(x, self._short) or 1.0)
        self.steps, self.restarts, self._since = 0, 0, 0
        self._first_residual = self._last_residual = math.inf
        self.value, self.bound, self.answer, self.prices = -math.inf, math.inf, x, prices
        self._look()

    def _lay_out(self, problem: MaxMinLP) -> None:
        """Columns scaled to a largest packing coefficient of 1, covering rows to values near 1; variables that cover nothing left out."""
        from scipy.sparse import diags_array, vstack

        a, c = problem.packing.scipy, problem.covering.scipy
        largest = np.where(np.bincount(c.indices, minlength=c.shape[1]) > 0, a.max(axis=0).toarray().ravel(), 0.0)
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            self._scale, self._inverse_scale = _inverse(largest), largest
            a, c = a @ diags_array(self._scale), c @ diags_array(self._scale)
            a.eliminate_zeros()
            self._keep(vstack([a, -c], format="csr"))
            self._even, value = self._scaled_down(np.where(largest > 0.0, 1.0, 0.0))
            self.unit = math.ldexp(1.0, math.frexp(value)[1]) if 0.0 < value < math.inf else 0.0
            c = c * _inverse(np.array([self.unit]))[0]
        if not (np.isfinite(self._scale).all() and np.isfinite(c.data).all() and (c.data > 0.0).all()):
            raise UnsupportedError("saddle", {"coefficients whose quotients no double holds"})
        matrix = vstack([a, -c], format="csr")
        self._keep(matrix)
        self._short, self._long = (_inverse(np.asarray(abs(matrix).sum(axis=k), dtype=np.float64).ravel()) for k in (0, 1))

    def _keep(self, matrix: Any) -> None:
        by_column = matrix.tocsc()
        self._rows = matrix.indptr, matrix.indices, matrix.data
        self._columns = by_column.indptr, by_column.indices, by_column.data

    def run(self, stop: Stop, gap: float, most: float = math.inf) -> None:
        """Step until value and bound are within the relative ``gap``, ``stop`` is reached, or ``most`` steps are made."""
        from .packing_covering_kernels import steps

        while not self.closed(gap) and self.steps < most and not stop.reached():
            made = steps(
                stop.flag, *self._rows, *self._columns, self._packing, self._short / self._balance, self._long * self._balance, self._x,
                self._prices, *self._next, *self._anchors, self._level, self._since, int(min(ROUND, most - self.steps)),
            )  # fmt: skip
            self.steps += made
            self._since += made
            if made:
                self._look()
                if self._wants_restart():
                    self._restart()

    def closed(self, gap: float) -> bool:
        """Whether value and bound are within the relative ``gap``."""
        return self.value >= self.bound / (1.0 + gap)

    def own(self, x: Floats) -> Floats:
        """The problem's own variables."""
        return np.asarray(x * self._scale)

    def evidence(self) -> Evidence:
        """Evidence of the best bound."""
        data = {"covering": self.prices[self._packing :].tolist(), "packing": self.prices[: self._packing].tolist()}
        return Evidence("packing-covering-duals", "prices of packing and covering rows", self.bound, data)

    def _look(self) -> None:
        """Make the last plain step feasible on both sides, and keep what is better than before."""
        from .packing_covering_kernels import pay_for_all

        x, value = self._scaled_down(self._next[0].copy())
        if value * self.unit > self.value:
            self.answer, self.value = x, value * self.unit
            self._news(self, "answer")
        (starts, columns, _), prices = self._rows, self._next[1].copy()
        bound = pay_for_all(starts, columns, *self._columns, self._packing, prices) * self.unit
        bound *= 1.0 + (int(np.diff(self._columns[0]).max(initial=0)) + 16) * _EPS  # the checker rounds upwards
        if bound < self.bound:
            self.prices, self.bound = prices, bound
            self._news(self, "bound")

    def _scaled_down(self, x: Floats) -> tuple[Floats, float]:
        """``x``, divided in place until all packing rows are kept, and its least coverage."""
        from .packing_covering_kernels import scale_down

        return x, scale_down(*self._rows, *self._columns[:2], self._packing, x)

    def _wants_restart(self) -> bool:
        moved = (point - ahead for point, ahead in zip((self._x, self._prices), self._next, strict=True))
        far, wide = map(_length, moved, (self._short, self._long))
        residual = math.hypot(far * math.sqrt(self._balance), wide / math.sqrt(self._balance))
        if self._since <= ROUND:
            self._first_residual = residual
        rises, self._last_residual = residual > self._last_residual, residual
        return residual < self._first_residual * (NECESSARY if rises else SUFFICIENT) or self._since >= LONGEST * self.steps

    def _restart(self) -> None:
        """Go on from the last plain step; the sides' steps are weighed by how far either came since the last restart."""
        far, wide = map(_length, (new - old for new, old in zip(self._next, self._anchors, strict=True)), (self._short, self._long))
        if 0.0 < far < math.inf and 0.0 < wide < math.inf:
            self._balance = math.sqrt(self._balance * wide / far)
        for point, anchor, ahead in zip((self._x, self._prices), self._anchors, self._next, strict=True):
            point[:] = anchor[:] = ahead
        self.restarts, self._since, self._last_residual = self.restarts + 1, 0, math.inf


def _inverse(values: Floats) -> Floats:
    """1 over each, 0 for 0."""
    with np.errstate(over="ignore", divide="ignore"):
        return np.where(values > 0.0, 1.0 / values, 0.0)


def _length(move: Floats, steps: Floats) -> float:
    """Euclidean length of a move in the metric of the lengths of steps."""
    with np.errstate(over="ignore", under="ignore"):
        return float(np.sqrt(np.sum(move**2 * _inverse(steps))))


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

    def news(game: PackingCovering, what: str) -> None:
        if what == "answer":
            control.publish(game.own(game.answer), game.value)
        else:
            control.publish(bound=game.bound, evidence=(game.evidence(),))

    game = PackingCovering(problem, start if usable else None, news)
    game.run(stop, max(options.gap, least_gap), math.inf if options.iterations is None else options.iterations)
    optimal = game.closed(least_gap)
    statistics: dict[str, Any] = {"steps": game.steps, "restarts": game.restarts}
    if options.start is not None:
        statistics["start"] = "used" if usable else "ignored"
    limit = "none" if optimal else "gap" if game.closed(options.gap) else stop.reached() or "iterations"
    return RawResult(
        "optimal" if optimal else "feasible", limit, game.own(game.answer), game.value, game.bound, statistics=statistics,
        evidence=(game.evidence(),),
    )  # fmt: skip
