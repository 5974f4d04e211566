"""Engine ``supported-paths``: the least cost at risk by shortest paths under weights of mean and variance, proved by their potentials."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from ....formulations.problem import Problem
from ....formulations.stop import Stop
from ....instances.errors import UnsupportedError
from ...backend import BACKENDS, Control, Engine, Options, RawResult

if TYPE_CHECKING:
    from ....formulations.risk.uncertain_path import UncertainPath


@BACKENDS.register("supported-paths")
class SupportedPathsEngine(Engine):
    """Shortest paths under weights that close in on the least cost at risk (Aneja and Nair 1979; Nikolova et al. 2006).

    Each weight asked about is one run of Dijkstra's algorithm, and a half-plane of the bound.
    """

    name = "supported-paths"
    package = "scipy"
    modules = ("scipy",)
    summary = "optimal paths of uncertain costs by shortest paths under weights, with a proof"
    interrupts = "keeps the best path and the bound so far"
    honours = frozenset()
    one_thread = bounds_itself = True
    order = 10
    family = "uncertain-path"
    features = frozenset({"normal-costs", "risk-aversion"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        from .path_search.supported_paths import supported_paths

        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        asked = cast("UncertainPath", problem)
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)
        made = supported_paths(asked, stop)
        value = asked.value(made.best.mean, made.best.variance)
        status, limit = ("optimal", "none") if made.complete else ("feasible", stop.reached())
        bound = value if made.complete else None
        return RawResult(
            status, limit, made.best.path, value, bound, statistics={"weights": len(made.found)}, evidence=(made.evidence(asked),)
        )
