"""PyVRP alone as a solver of campaigns: given the whole numbers that waybound gives it, in a process that knows nothing of waybound."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from waybound.extending import BACKENDS, Control, Engine, Options, RawResult
from waybound.formulations.routing.routes import Routes
from waybound.solvers.engines.routing.pyvrp import PyVRP

from ._harness import in_a_fresh_process
from .overhead import BISECTED, integers

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
        with tempfile.TemporaryDirectory() as folder:
            data = Path(folder) / "data.npz"
            np.savez(data, **integers(problem))
            script = Path(__file__).with_name("_bare_pyvrp.py")
            limit, work = ("time", f"{options.time_limit}s") if options.iterations is None else ("iterations", options.iterations)
            told = in_a_fresh_process(script, data, work, options.seed % 2**32)
        return RawResult("feasible", limit, Routes.of(told["routes"]))
