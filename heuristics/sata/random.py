"""Random: the baseline that every method should beat."""

import numpy as np

from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.selections import Selection
from ...formulations.sata.submodular_selection import SubmodularSelection
from ..heuristic import Context, Outcome, heuristic
from .greedy_steps.limits import ANY_CONSTRAINT, ANY_FUNCTION, Limits, first_allowed, not_whole


@heuristic(
    "random", ("selection", "max-min"), ANY_FUNCTION | ANY_CONSTRAINT | {"sensing", "whole-actions"},
    "a random action for each robot, or a random maximal set", refuses=not_whole,
)  # fmt: skip
def random(problem: SubmodularSelection | BottleneckSATA, context: Context) -> Outcome:
    """A random maximal answer, without a guarantee.

    Robots: each takes one of its actions, all alike. Cardinality limit and partition matroid: all full sets are alike. Others: the elements
    come in a random order, and each is taken that is still allowed.

    Source: the baseline of Sung (2019), 3.5.1.
    """
    picks = np.array(first_allowed(problem, context.rng.permutation(problem.num_elements)), dtype=np.int64)
    limits = Limits.if_any(problem)
    if limits is not None:  # robot by robot
        picks = picks[np.argsort(limits.groups[picks], kind="stable")]
    return Outcome(Selection(tuple(picks.tolist())))
