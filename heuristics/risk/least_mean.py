"""Heuristic ``least-mean``: the path of the least mean cost, whatever its variance (naive A*)."""

from ...formulations.evidence import Guarantee
from ...formulations.risk.uncertain_path import UncertainPath
from ...solvers.engines.risk.supported_paths import shortest_path
from ..heuristic import Context, Outcome, heuristic


@heuristic(
    "least-mean", "uncertain-path", {"normal-costs", "risk-aversion"}, "the path of the least mean cost (naive A*)",
    "1 at a risk of 1/2, else no guarantee",
)  # fmt: skip
def least_mean(problem: UncertainPath, context: Context) -> Outcome:
    """A shortest path by means (Dijkstra 1959)."""
    path = shortest_path(problem.graph, (1.0, 0.0)).path
    exact = Guarantee(1.0, "mean of the path = least mean", ("the risk is 1/2, where the value is the mean",), "Dijkstra (1959)")
    return Outcome(path, None if problem.z else exact)
