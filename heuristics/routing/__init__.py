"""Approximations for routing problems."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ... import _guard as _guard
from ..heuristic import HEURISTICS, Heuristic, Outcome

Run = Callable[..., Outcome]


def routing_heuristic(name: str, features: frozenset[str], summary: str, **further: Any) -> Callable[[Run], Run]:
    """Decorator that registers a heuristic for routing problems; ``further`` are fields of ``Heuristic``."""

    def register(run: Run) -> Run:
        HEURISTICS.add(name, Heuristic(name, ("routing",), features, run, summary, **further))
        return run

    return register
