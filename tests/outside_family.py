"""A family of problems that no module of waybound knows: jobs on one machine, done one after the other."""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import pandas as pd

from waybound.formulations.evaluation import Checklist, Evaluation
from waybound.formulations.evidence import CHECKERS, Evidence, Reason
from waybound.formulations.problem import PROBLEMS, Problem
from waybound.heuristics.heuristic import HEURISTICS, Context, Heuristic, Outcome
from waybound.instances.errors import InputError, UsageError
from waybound.instances.instance import digest
from waybound.instances.kinds import KINDS, Kind


@dataclass(frozen=True)
class Jobs:
    """Durations by name, and when the machine stops."""

    kind: ClassVar[str] = "jobs"
    durations: dict[str, float]
    horizon: float = math.inf
    name: str = "jobs"
    format: str = "json"
    problem: str = "least-waiting"
    problems: tuple[str, ...] = ("least-waiting",)
    notes: tuple[str, ...] = ()


class LeastWaiting(Problem):
    """Minimise the sum of the times at which the jobs are done; an answer is their order, a tuple of names."""

    family: ClassVar[str] = "one-machine"
    answer_suffixes: ClassVar[tuple[str, ...]] = (".order",)

    def __init__(self, jobs: Jobs) -> None:
        self.jobs, self.name, self.problem, self.notes = jobs, jobs.name, jobs.problem, jobs.notes

    senses = ("min",)
    convention = "exact"

    def digest(self) -> str:
        return digest("jobs", sorted(self.jobs.durations.items()), self.jobs.horizon)

    def features(self) -> frozenset[str]:
        return frozenset({"jobs"})

    def facts(self) -> dict[str, Any]:
        times = self.jobs.durations
        return {"jobs": len(times), "longest_jobs": sorted(times, key=lambda j: -times[j])[:2], "horizon": self.jobs.horizon}

    def infeasibility_reasons(self, stopped: Callable[[], bool] = lambda: False) -> Iterator[Reason]:
        evidence = Evidence("machine-time", "all jobs together", math.inf, {})
        if machine_time(self, evidence.data) == math.inf:
            yield Reason("machine", "hours", f"the jobs take longer than {self.jobs.horizon:g}", evidence)

    def evaluate(self, answer: Any) -> Evaluation:
        judge, times = Checklist(), self.jobs.durations
        for job in times:
            judge.test("once", abs(answer.count(job) - 1), f"{job} is done {answer.count(job)} times")
        done = list(itertools.accumulate(times[job] for job in answer))
        judge.test("horizon", max(done, default=0.0) - self.jobs.horizon, "the machine runs too long")
        return Evaluation((math.fsum(done),), judge.checks(("once", "horizon")), tuple(judge.violations), {"end": max(done, default=0.0)})

    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        return {"kind": "order", "jobs": list(answer)}

    def answer_from_json(self, data: Any) -> tuple[str, ...]:
        if not isinstance(data, Mapping) or data.get("kind") != "order" or not set(data["jobs"]) <= set(self.jobs.durations):
            raise InputError("not an order of these jobs")
        return tuple(data["jobs"])

    def answer_to_frame(self, answer: Any) -> pd.DataFrame:
        times = [self.jobs.durations[job] for job in answer]
        return pd.DataFrame({"job": list(answer), "done": list(itertools.accumulate(times))})

    def answer_to_text(self, answer: Any, suffix: str, objective: float | None = None) -> str:
        return f"{' > '.join(answer)}\n{objective:g}\n"

    def answer_from_text(self, text: str) -> tuple[Any, float | None]:
        order, _, total = text.partition("\n")
        if " > " not in order:
            return super().answer_from_text(text)
        return tuple(order.split(" > ")), float(total)


def machine_time(problem: LeastWaiting, data: Mapping[str, Any]) -> float:
    """The checker: no order ends before the durations' sum."""
    return math.inf if math.fsum(problem.jobs.durations.values()) > problem.jobs.horizon else -math.inf


def shortest_first(problem: LeastWaiting, context: Context) -> Outcome:
    """Smith's rule."""
    return Outcome(tuple(sorted(problem.jobs.durations, key=problem.jobs.durations.__getitem__)))


def _problem(instance: Any, problem: str, settings: dict[str, Any]) -> LeastWaiting:
    if settings:
        raise UsageError(f"{problem} takes no settings")
    return LeastWaiting(instance)


def register(registered: Callable[..., Any]) -> None:
    """All of the family, for one test; see the fixture ``registered``."""
    registered(KINDS, "jobs", Kind("jobs", lambda made: {"durations": made.durations}, lambda data: Jobs(**data)))
    registered(PROBLEMS, "least-waiting", _problem)
    registered(CHECKERS, "machine-time", machine_time)
    registered(
        HEURISTICS, "shortest-first",
        Heuristic("shortest-first", ("one-machine",), frozenset({"jobs"}), run=shortest_first, summary="shortest jobs first"),
    )  # fmt: skip
