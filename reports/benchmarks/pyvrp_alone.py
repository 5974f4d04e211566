"""PyVRP alone as a solver of campaigns: given the whole numbers that waybound gives it, in a process that knows nothing of waybound."""

from typing import Any

from waybound.extending import BACKENDS, Control, Engine, Options, RawResult
from waybound.formulations.routing.routes import Routes
from waybound.solvers.engines.routing.pyvrp import PyVRP

from .overhead import BISECTED, bare

UNTOLD = frozenset({"groups", "reloads", "overtime", "forbidden-moves", "several-windows"})
"""Features that the bare model of PyVRP leaves out."""


@BACKENDS.register("bare-pyvrp")
class BarePyVRP(Engine):
    """``_bare_pyvrp.py`` for so many iterations, or for the seconds of the time limit."""

    name, package, modules = "bare-pyvrp", "pyvrp", ("pyvrp",)
    summary = "PyVRP as its own documentation uses it"
    family, features = "routing", PyVRP.features - UNTOLD
    honours = frozenset({"iterations"})
    by_default = False

    def missing(self, problem: Any) -> frozenset[str]:
        lacking = PyVRP().missing(problem) | super().missing(problem)
        return lacking or (BISECTED if PyVRP().bisects(problem) else frozenset())

    def run(self, problem: Any, options: Options, control: Control) -> RawResult:
        self.begin(problem, options, control)
        limit, work = ("time", f"{options.time_limit}s") if options.iterations is None else ("iterations", options.iterations)
        told = bare(problem, "pyvrp", work, options.seed % 2**32)
        return RawResult("feasible", limit, Routes.of(told["routes"]))
