"""Random: the baseline that every method should beat."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...formulations.max_min.bottleneck_sata import BottleneckSATA
from ...formulations.problem import Problem
from ...formulations.selection.selections import Selection
from ...formulations.selection.submodular_selection import SubmodularSelection
from ...instances.selection.instance import Knapsack
from ..heuristic import HEURISTICS, Heuristic, Outcome, Setting
from .greedy_steps.limits import ANY_CONSTRAINT, ANY_FUNCTION, Limits, that_fit


def random(problem: Problem, setting: Setting) -> Outcome:
    """A random maximal answer.

    Parameters
    ----------
    problem : SubmodularSelection or BottleneckSATA
    setting : Setting
        Its generator draws.

    Returns
    -------
    Outcome
        Robots: each takes one of its actions, all alike. Cardinality limit and partition matroid: all full sets are alike. Knapsack:
        the elements come in a random order, and each is taken that still fits. No guarantee.

    Notes
    -----
    Source: the baseline of Sung (2019), 3.5.1.
    """
    assert isinstance(problem, SubmodularSelection | BottleneckSATA)
    if isinstance(problem, SubmodularSelection) and isinstance(problem.constraint, Knapsack):
        return Outcome(Selection(tuple(that_fit(setting.rng.permutation(problem.num_elements).tolist(), problem.constraint))))
    limits = Limits.of(problem)
    picks = limits.first(setting.rng.permutation(len(limits.groups)))
    return Outcome(Selection(tuple(picks[np.argsort(limits.groups[picks], kind="stable")].tolist())))  # robot by robot


def _refuses(problem: Any) -> frozenset[str]:
    return frozenset({f"{problem.problem} problems"}) if problem.family == "max-min" and problem.problem != "bottleneck" else frozenset()


HEURISTICS.add(
    "random",
    Heuristic(
        name="random",
        families=("selection", "max-min"),
        features=ANY_FUNCTION | ANY_CONSTRAINT | {"sensing", "whole-actions"},
        run=random,
        summary="a random action for each robot, or a random maximal set",
        refuses=_refuses,
    ),
)
