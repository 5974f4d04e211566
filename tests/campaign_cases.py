"""Campaigns for tests: files, workers that do runs in this process, and runs made up."""

import json
import os
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Self

from waybound.reports.campaigns.campaign import Planned
from waybound.reports.campaigns.instance_list import Named
from waybound.reports.campaigns.one_run import Outcome, Task, run_task
from waybound.reports.campaigns.setting import Setting

SMALL = {"results": "r.sqlite", "instances": ["demo-tiny"], "heuristics": ["savings"], "seeds": [1, 2], "time_limit": 60, "bound_time": 0}
"""The keys of a campaign of two runs."""


def toml(value: Any) -> str:
    """A value as TOML has it."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {toml(own)}" for key, own in value.items()) + "}"
    return "[" + ", ".join(map(toml, value)) + "]" if isinstance(value, list) else json.dumps(value)


def campaign_file(folder: Path, /, without: str = "", **changes: Any) -> Path:
    """A campaign file in ``folder``: ``SMALL`` with changes."""
    keys = {key: value for key, value in {**SMALL, **changes}.items() if key != without}
    path = folder / "c.toml"
    path.write_text("".join(f"{key} = {toml(value)}\n" for key, value in keys.items()))
    return path


class Here:
    """Does runs one after the other in this process; ``of`` makes outcomes of tasks."""

    def __init__(self, of: Any = run_task) -> None:
        self.of, self.done = of, 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *fault: object) -> None:
        pass

    def outcomes(self, tasks: Iterator[tuple[Planned, Task]]) -> Iterator[tuple[Planned, Outcome]]:
        place = Path.cwd()
        try:
            for run, task in tasks:
                self.done += 1
                yield run, self.of(task)
        finally:
            os.chdir(place)


def planned(instance: str = "a", method: str = "savings", seed: int = 1, **setting: Any) -> Planned:
    """A run that nobody does."""
    return Planned(Named(instance, f"{instance}.txt", Path(f"{instance}.txt"), f"hash-{instance}"), Setting(method=method, **setting), seed)


def outcome(objective: float | None = 1.0, history: list[Any] | None = None, **row: Any) -> Outcome:
    """The outcome of a run that nobody did."""
    told = {
        "problem": "vrptw", "sense": "min", "convention": "exact", "status": "feasible", "limit": "none", "objective": objective,
        "checked": int(objective is not None), "faults": 0, "seconds": 1.0, "run_seconds": 1.1, **row,
    }  # fmt: skip
    documents = {"solution": "{}", "certificate": "{}", "history": json.dumps(history or [])}
    return Outcome(told, documents, {"waybound": "0"}, {"name": "here"})


def hundred_instances() -> Iterator[tuple[Planned, Outcome]]:
    """Made up: 100 instances, 6 methods, 5 seeds."""
    draw = random.Random(1)
    for k in range(100):
        best = draw.uniform(500.0, 100_000.0)
        for method in ("pyvrp", "ortools", "vroom", "savings", "insertion", "ruin-recreate"):
            for seed in range(1, 6):
                value = best * (1.0 + abs(draw.gauss(0.0, 0.03)))
                history = [[0.5 * step, "solve", [value * (1.1 - 0.02 * step)], None] for step in range(1, 6)]
                yield (
                    planned(f"X-n{101 + k}-k25", method, seed),
                    outcome(
                        value, history, status="optimal" if draw.random() < 0.3 else "feasible", bound=0.97 * best, bound_kind="verified",
                        verified_bound=0.97 * best, gap=value / best - 0.97, seconds=draw.uniform(0.1, 60.0),
                    ),
                )  # fmt: skip
