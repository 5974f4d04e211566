"""Risky paths: look-back and two stages against what they state, on maps whose paths are all enumerated."""

from typing import Any

from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import Configuration
from .families import risky_graphs as families


def _of_rewards(problem: Any) -> tuple[float, float]:
    """All rewards over the least one at most; 1 where the last alone counts."""
    rewards = problem.rewards[problem.rewards > 0.0]
    return 1.0, 1.0 if problem.graph.discount == 0.0 else float(rewards.sum() / rewards.min())


def _of_moves(problem: Any) -> float | None:
    """Nothing is known where a risk hangs on the way before the last move."""
    return None if problem.graph.traverse else 1.0


guarantee_study(
    "look-back", "least risk by labels of two states, stated 1", 300, [Configuration("two steps", "look-back", _of_moves)],
    [families.least_risk(), families.gathered_risk()],
    source="Xiao (2019), section 4.2.2.1, Algorithm 2", claim="the least risk, where risks are of places and moves",
)  # fmt: skip
guarantee_study(
    "two-stage", "the best of the least risky paths, stated by its rewards", 300, [Configuration("two steps", "two-stage", _of_rewards)],
    [families.rewarded(1.0), families.rewarded(0.0), families.decoys()],
    source="Xiao (2019), section 4.2.2.2, Algorithm 3", claim="none in the source; here what the rewards on the way state",
)  # fmt: skip
