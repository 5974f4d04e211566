"""Engine ``non-dominated-paths``: the least cost at risk among all paths that none other dominates in mean and variance."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from ....formulations.problem import Problem
from ....formulations.stop import Stop
from ....instances.errors import UnsupportedError
from ...backend import BACKENDS, Control, Engine, Options, RawResult

if TYPE_CHECKING:
    from ....formulations.risk.uncertain_path import UncertainPath


@BACKENDS.register("non-dominated-paths")
class NonDominatedPaths(Engine):
    """Label setting over (mean, variance): the cost at risk grows in both, so an optimal path is not dominated.

    Its optimum is a claim of its own, without evidence: a second opinion on what ``supported-paths`` proves.
    """

    name = "non-dominated-paths"
    package = "scipy"
    modules = ("scipy",)
    summary = "optimal paths of uncertain costs by label setting over mean and variance"
    interrupts = "keeps the best of the paths found so far"
    honours = frozenset()
    one_thread = bounds_itself = True
    order = 20
    family = "uncertain-path"
    features = frozenset({"normal-costs", "risk-aversion"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        from .path_search.non_dominated_paths import non_dominated_paths

        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        asked = cast("UncertainPath", problem)
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)
        made = non_dominated_paths(asked.graph, stop=stop)
        statistics = {"paths": len(made.paths), "labels": made.labels}
        if not made.paths:
            return RawResult("unknown", stop.reached(), statistics=statistics)
        values = [asked.value(m, v) for m, v in zip(made.means.tolist(), made.variances.tolist(), strict=True)]
        best = min(range(len(values)), key=values.__getitem__)
        if not made.complete:
            return RawResult("feasible", stop.reached(), made.paths[best], values[best], statistics=statistics)
        return RawResult("optimal", "none", made.paths[best], values[best], values[best], statistics=statistics)
