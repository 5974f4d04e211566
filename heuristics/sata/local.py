"""Local: robots that divide themselves after what they learn of their surroundings."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.evidence import Evidence, Guarantee
from ...formulations.sata.balls import Floats, even_shares
from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.max_min_lp import MaxMinLP, RobotsOf
from ...formulations.sata.selections import Selection
from ...formulations.stop import Stop, Stopped
from ...instances.errors import UsageError
from ...instances.sata.sensing_graph import SensingGraph
from ...solvers.engines.sata.local_max_min.cleaning import CleanGraph, clean
from ...solvers.engines.sata.local_max_min.shares import MOST_LAYERS, check_options, local_shares
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .rounding import check_ties, largest_shares

SOURCE = (
    "Floréen, Hassinen, Kaasinen, Kaski, Musto and Suomela (2011), Theory of Computing Systems 49, 672-697; "
    "Sung (2019), Multi-Robot Coordination for Hazardous Environmental Monitoring, theorem 1"
)


@heuristic(
    "local", "max-min", {"sensing", "whole-actions", "packing-covering"},
    "the local algorithm for max-min LPs: each robot decides from what lies within 3h - 2 hops",
    "OPT / value <= Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T) for shares; none for whole actions",
)  # fmt: skip
def local(
    problem: BottleneckSATA | MaxMinLP,
    context: Context,
    *,
    h: int = 4,
    heights: Any = None,
    eps: float = 0.1,
    search: str = "secant",
    step: float = 0.1,
    smoothing: str = "layers",
    normalise: bool = True,
    ties: str = "last",
    ball: bool = True,
    messages: bool = False,
) -> Outcome:
    """The local algorithm for max-min linear programs, of robots or with one packing row a variable; its options:
    docs/local_algorithm.md#options.

    Shares depend on what lies within 3h - 2 hops, and are guaranteed ``OPT / value <= Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T)``, which
    improves with h, as measured values need not; the additive search has the eps that its step amounts to. Whole actions are the largest
    shares, without a guarantee. The context's LP solver is used for the bound alone, its generator for random ties.

    Source: Floréen et al. (2011); Sung (2019), 3.4.1, Algorithm 2 and Theorem 1; proved in
    docs/formulations/bottleneck.md#the-local-algorithm.
    """
    layers = _heights(h, heights)
    for height in layers:
        check_options(height, eps, search, step, smoothing)
    check_ties(ties)
    for name, value in (("normalise", normalise), ("ball", ball), ("messages", messages)):
        if not isinstance(value, bool):
            raise UsageError(f"{name} must be true or false, not {value!r}", "malformed")
    stop = context.begin()
    task = _task(problem)
    options = {"eps": eps, "search": search, "step": step, "smoothing": smoothing, "normalise": normalise}
    runs: list[_Run] = []
    for height in layers:
        try:
            run = _run(task, height, messages, options, ties, context.rng, stop)
        except Stopped:
            break
        if not runs or run.rank > max(r.rank for r in runs):
            context.publish(run.answer)
        runs.append(run)
    cut = len(runs) < len(layers)
    if not runs:  # better than nothing
        runs.append(_judged(task, 0, even_shares(task.graph), math.nan, {}, ties, context.rng))
    best = max(runs, key=lambda run: run.rank)
    evidence: tuple[Evidence, ...] = ()
    if ball or task.unseen.size:
        evidence = _bound(task, best.coverage, context, stop)
    guarantee, notes = _guarantee(task, runs, search)
    if cut:
        done = f"the largest h was {best.h}" if best.h else "robots divide themselves evenly"
        notes.append(f"{done}: {CUT_SHORT}")
    limit = stop.reached() or "time" if cut else "none"
    return Outcome(best.answer, guarantee, evidence, _statistics(task, best, runs), "; ".join(notes), limit)


@dataclass(frozen=True)
class _Task:
    """The problem as one of robots."""

    robots: RobotsOf
    problem: BottleneckSATA
    graph: SensingGraph
    cleaned: CleanGraph
    whole: bool
    unseen: NDArray[np.int32]

    def answer(self, shares: Floats, actions: NDArray[np.int32]) -> Any:
        """The problem's own answer, from shares or from whole actions."""
        return Selection(tuple(actions.tolist())) if self.whole else self.robots.answer(shares)


@dataclass(frozen=True)
class _Run:
    """One run; with h = 0 robots that divide themselves evenly.

    ``value`` and ``rounded`` are of the targets that somebody sees; ``rank`` orders runs.
    """

    h: int
    answer: Any
    coverage: Floats
    value: float
    rounded: float
    rank: tuple[float, float]
    relative_eps: float
    counts: dict[str, int]


def _heights(h: Any, heights: Any) -> list[int]:
    if heights is None:
        return [h]
    numbers: Any = heights
    if isinstance(numbers, str):
        numbers = [part.strip() for part in numbers.split(",")]
        numbers = [int(part) if part.isascii() and part.isdigit() else part for part in numbers]
    elif isinstance(numbers, int | np.integer) and not isinstance(numbers, bool):
        numbers = list(range(1, int(numbers) + 1)) if 1 <= numbers <= MOST_LAYERS else []
    valid = isinstance(numbers, Sequence | np.ndarray) and len(numbers) > 0
    if not valid or not all(isinstance(k, int | np.integer) and not isinstance(k, bool) and 1 <= k <= MOST_LAYERS for k in numbers):
        raise UsageError(f"heights must be a whole number from 1 to {MOST_LAYERS}, or a list of such, not {heights!r}", "out-of-range")
    return sorted({int(k) for k in numbers})


def _task(problem: BottleneckSATA | MaxMinLP) -> _Task:
    robots = RobotsOf(problem)
    graph = robots.graph
    asked = problem if isinstance(problem, BottleneckSATA) else BottleneckSATA(graph, fractional=True)
    return _Task(robots, asked, graph, clean(graph), not asked.fractional, graph.unseen_targets)


def _run(task: _Task, h: int, messages: bool, options: dict[str, Any], ties: str, rng: "np.random.Generator", stop: Stop) -> _Run:
    counts: dict[str, int] = {}
    if messages:
        from ...solvers.engines.sata.local_max_min.messages import exchange

        talk = exchange(task.graph, h, stop=stop, **options)
        shares, relative = talk.shares, talk.relative_eps
        counts = {"rounds": talk.rounds, "messages": talk.messages, "bytes": talk.bytes, "largest_message_bytes": talk.most_bytes}
    else:
        result = local_shares(task.cleaned, h, stop=stop, **options)
        shares, relative = result.shares, result.relative_eps
    return _judged(task, h, shares, relative, counts, ties, rng)


def _judged(task: _Task, h: int, shares: Floats, relative: float, counts: dict[str, int], ties: str, rng: "np.random.Generator") -> _Run:
    coverage = task.problem.coverage(shares)
    value = _least(task, coverage)
    actions = largest_shares(task.graph, shares, ties, rng) if task.whole else np.zeros(0, dtype=np.int32)
    rounded = math.nan
    if task.whole:
        chosen = np.zeros(task.graph.num_actions)
        chosen[actions] = 1.0
        rounded = _least(task, task.problem.coverage(chosen))
    rank = (rounded, value) if task.whole else (value, 0.0)
    return _Run(h, task.answer(shares, actions), coverage, value, rounded, rank, relative, counts)


def _least(task: _Task, coverage: Floats) -> float:
    """The least coverage of a target that somebody sees."""
    if not task.unseen.size:
        return float(coverage.min())
    seen = np.ones(len(coverage), dtype=bool)
    seen[task.unseen] = False
    return float(coverage[seen].min(initial=math.inf)) if seen.any() else 0.0


def _ratio(cleaned: CleanGraph, run: _Run) -> float:
    return cleaned.delta_r * (1.0 - 1.0 / cleaned.delta_t) * (1.0 + 1.0 / run.h) * (1.0 + run.relative_eps)


def _guarantee(task: _Task, runs: list[_Run], search: str) -> tuple[Guarantee | None, list[str]]:
    """The best guarantee of the runs, whose best answer was kept, where every assumption holds; else why not."""
    notes = []
    if task.unseen.size:
        names = ", ".join(task.graph.target_name(int(k)) for k in task.unseen[:5])
        more = ", ..." if len(task.unseen) > 5 else ""
        notes.append(f"no action sees {len(task.unseen)} of the targets ({names}{more}), so the value is 0 whatever is done")
    if task.whole:
        notes.append("whole actions are the largest shares, for which nothing is guaranteed: the guarantee is one of shares")
    if notes:
        return None, notes
    if not runs[0].h:
        return None, notes
    cleaned, run = task.cleaned, min(runs, key=lambda run: _ratio(task.cleaned, run))
    statement = (
        "OPT / value <= Delta_R (1 + eps) (1 + 1/h) (1 - 1/Delta_T) "
        f"= {cleaned.delta_r} (1 + {run.relative_eps:.4g}) (1 + 1/{run.h}) (1 - 1/{cleaned.delta_t})"
    )
    eps = f"eps = {run.relative_eps:.6g} > 0"
    if search == "step":
        eps += ", which the additive step amounts to here"
    assumptions = (
        "every target is seen by some action", f"h = {run.h} >= 1", eps,
        f"Delta_R = {cleaned.delta_r} and Delta_T = {cleaned.delta_t} without actions that see nothing, at least 2 each",
        "robots divide themselves: the value is that of shares",
    )  # fmt: skip
    return Guarantee(_ratio(cleaned, run), statement, assumptions, SOURCE), notes


def _bound(task: _Task, coverage: Floats, context: Context, stop: Stop) -> tuple[Evidence, ...]:
    if stop.reached() and not task.unseen.size:
        return ()
    from ...solvers.bounds.sata.ball import ball_evidence

    evidence = ball_evidence(task.graph, coverage, stop, context.linear)
    return () if evidence is None else (task.robots.evidence(evidence),)


def _statistics(task: _Task, best: _Run, runs: list[_Run]) -> dict[str, Any]:
    cleaned = task.cleaned
    statistics: dict[str, Any] = {
        "h": best.h, "delta_r": cleaned.delta_r, "delta_t": cleaned.delta_t, "relative_eps": best.relative_eps,
        "fractional_value": best.value, **best.counts,
    }  # fmt: skip
    if not best.h:
        del statistics["relative_eps"]
    if task.whole:
        statistics["rounded_value"] = best.rounded
    if task.unseen.size:
        statistics["unseen_targets"] = int(task.unseen.size)
    if len(runs) > 1:
        statistics["values_by_height"] = {str(run.h): run.value for run in runs}
        if task.whole:
            statistics["rounded_by_height"] = {str(run.h): run.rounded for run in runs}
    return statistics
