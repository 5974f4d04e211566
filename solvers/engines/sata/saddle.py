"""Saddle: first-order methods and an interior point for max-min linear programs of robots that are too large for general solvers."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.sata.balls import Floats, even_shares, near_one
from ....formulations.sata.max_min_lp import RobotsOf
from ....formulations.stop import Stop, Stopped
from ....instances.errors import UnsupportedError, UsageError
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from ...bounds.sata.ball import unseen_evidence, weights_evidence
from ...linear_programs import LinearPrograms

if TYPE_CHECKING:
    from .saddle_steps.game import Game, Record

LEAST_GAP = 5e-7
"""Gap that ends a search for which a smaller one is asked: half of the gap that is told apart from an optimum."""

FIRST_PASSES, FIRST_WORK = 16.0, 1e6
"""Passes over the graph, and edges, that the work on single clusters may read before the whole game is played."""

MOST_LAYERS = 1000


@BACKENDS.register("saddle")
class Saddle(Engine):
    """Work on the targets that fall short of a proved bound, and where all of them matter first-order methods or an interior point; bounds
    from balls and prices. Programs with several packing rows a variable, and min-max ones, go to ``PackingCovering``.

    ``iterations`` counts passes over the graph, of which a first-order step is one and of the interior point many. Option ``h``:
    start from the local algorithm with so many layers instead of robots that divide themselves evenly (0, the default, as the local
    algorithm takes longer than it saves).
    """

    name = "saddle"
    package = "numba"
    modules = ("numba", "highspy", "scipy")
    summary = "first-order and interior-point methods for large max-min LPs, with proved bounds"
    interrupts = "keeps the best answer and the best bound"
    bounds_itself = True
    options: ClassVar[Mapping[str, Any]] = {"h": 0}
    family = "max-min"
    features = frozenset({"sensing", "packing-covering", "several-packing-rows", "min-max"})

    def missing(self, problem: Problem) -> frozenset[str]:
        lacking = super().missing(problem)
        if lacking or "min-max" not in problem.features():
            return lacking
        packed = np.bincount(problem.packing.indices, minlength=problem.num_variables) > 0  # type: ignore[attr-defined]
        covers_for_nothing = not packed[problem.covering.indices].all()  # type: ignore[attr-defined]
        return frozenset({"variables that cover without a packing row"} if covers_for_nothing else ())

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        h: int = self.converted(options).extra.get("h", 0)
        if not 0 <= h <= MOST_LAYERS:
            raise UsageError(f"saddle: h must be a whole number from 0 to {MOST_LAYERS}, not {h!r}", "out-of-range")
        if problem.features() & {"several-packing-rows", "min-max"}:
            if h:
                message = "saddle: h, a start from the local algorithm, needs a max-min program and variables of one packing row each"
                raise UsageError(message, "out-of-range")
            from .saddle_steps.packing_covering import search_rows

            _compile("sums", "packing_covering")
            return search_rows(problem, options, control, LEAST_GAP)  # type: ignore[arg-type]
        task = _Task(problem)
        if len(task.graph.unseen_targets):
            return task.unseen(options)
        _compile("descent", "sums", "regret", "halpern", "normal", "multigrid")
        return _search(task, h, options, control)


class _Task:
    """The problem as one of robots, with weights near 1."""

    def __init__(self, problem: Problem) -> None:
        self.robots = RobotsOf(problem)  # type: ignore[arg-type]
        self.graph, self.scale = self.robots.graph, self.robots.scale
        self.scaled, self.unit = near_one(self.graph)

    def answer(self, shares: Floats) -> Floats:
        """The problem's answer, from shares."""
        load = np.bincount(self.graph.robot_of_action, shares, minlength=self.graph.num_robots)
        shares = shares / np.maximum(load, 1.0)[self.graph.robot_of_action]
        return self.robots.answer(shares)

    def shares(self, answer: Any) -> Floats | None:
        """Shares from an answer to start with, all robots used up; None where it is none."""
        values = np.asarray(answer, dtype=np.float64)
        if values.shape != (self.graph.num_actions,) or not np.isfinite(values).all():
            return None
        shares = np.maximum(values, 0.0)
        if self.scale is not None:
            shares = np.where(np.isfinite(self.scale), shares * np.where(np.isfinite(self.scale), self.scale, 0.0), 0.0)
        return self.used_up(shares)

    def used_up(self, shares: Floats) -> Floats:
        """Shares in proportion that sum to 1 a robot; even ones where a robot has none."""
        load = np.bincount(self.graph.robot_of_action, shares, minlength=self.graph.num_robots)[self.graph.robot_of_action]
        return np.where(load > 0.0, shares / np.where(load > 0.0, load, 1.0), even_shares(self.graph))

    def value(self, record: Record) -> float:
        return record.value / self.unit

    def bound(self, record: Record) -> float:
        return record.bound / self.unit

    def evidence(self, record: Record) -> tuple[Evidence, ...]:
        """Evidence of the record's bound, in the problem's own terms."""
        if not np.isfinite(record.bound):
            return ()
        count = len(record.targets)
        source = f"prices of {count} target{'' if count == 1 else 's'}"
        return (self.robots.evidence(weights_evidence(record.targets, record.weights, self.bound(record), source)),)

    def unseen(self, options: Options) -> RawResult:
        """The result where nobody sees some target: the value is 0 whatever is done."""
        start = None if options.start is None else self.shares(options.start)
        proof = self.robots.evidence(unseen_evidence(self.graph))
        answer = self.answer(even_shares(self.graph) if start is None else start)
        message = f"no action sees {len(self.graph.unseen_targets)} of the targets, so the value is 0 whatever is done"
        return RawResult("optimal", "none", answer, 0.0, 0.0, message=message, evidence=(proof,))


def _search(task: _Task, h: int, options: Options, control: Control) -> RawResult:
    from .saddle_steps.game import Game, Limits, Record
    from .saddle_steps.programs import Programs
    from .saddle_steps.refinement import refine
    from .saddle_steps.whole_game import play

    graph = task.scaled
    stop = Stop(options.time_limit)
    control.on_stop(stop.ask)
    limits = Limits(stop)

    def news(record: Record, what: str) -> None:
        if what == "answer":
            control.publish(task.answer(record.shares), task.value(record))
        else:
            control.publish(bound=task.bound(record), evidence=task.evidence(record))

    record = Record(graph, max(options.gap, LEAST_GAP), news)
    game = Game(graph, record, limits, Programs(stop, LinearPrograms(options.lp_solver, options.seed)), options.threads)
    if options.iterations is not None:
        limits.most_work = options.iterations * game.pass_work
    shares = None if options.start is None else task.shares(options.start)
    if shares is None:
        shares = even_shares(graph)
        if h and not limits.reached():
            from .local_max_min.shares import local_shares

            record.offer(shares)  # before it takes its time
            with contextlib.suppress(Stopped):
                shares = task.used_up(local_shares(graph, h, stop=stop).shares)
    refine(game, shares, FIRST_PASSES * game.pass_work + FIRST_WORK)
    steps = play(game)
    return _result(task, game, steps, options)


def _result(task: _Task, game: Game, steps: tuple[int, int], options: Options) -> RawResult:
    record, limits = game.record, game.limits
    optimal = record.bound - record.value <= LEAST_GAP * abs(record.value)
    statistics: dict[str, Any] = {
        "steps": steps[0], "interior_steps": steps[1], "passes": round(limits.work / game.pass_work, 3),
        "linear_programs": game.programs.solved, "priced_targets": len(record.targets),
    }  # fmt: skip
    if options.start is not None:
        statistics["start"] = "ignored" if task.shares(options.start) is None else "used"
    limit = "none" if optimal else "gap" if record.closed() else limits.reached()
    return RawResult(
        "optimal" if optimal else "feasible", limit, task.answer(record.shares), task.value(record),
        task.bound(record) if np.isfinite(record.bound) else None, statistics=statistics, evidence=task.evidence(record),
    )  # fmt: skip


@functools.cache
def _compile(*names: str) -> None:
    """Compile or load the kernels of these names, for the time limit is for the search alone."""
    from ....formulations.kernels import kernels

    for name in names:
        for one in kernels(f"{__package__}.saddle_steps.{name}_kernels"):
            one.make()
