"""Medians of clocks in fresh processes, and the check that two models are the same, for the compile benchmarks."""

import json
import statistics
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from waybound.formulations.programs.program import Program

from ._harness import Option, in_a_fresh_process

Once = Annotated[str, Option(help="one measurement of this alone, as JSON: what the fresh processes do")]
"""The contestant that a fresh process measures; "" for the table."""

PULP_RUNS = 3
"""PuLP takes long, so that more runs of it would be most of the time."""


def same_model(program: Program, path: Path) -> None:
    """Raise AssertionError unless the MPS file holds the program's numbers of rows, columns and entries, and the same values."""
    import highspy

    other = highspy.Highs()
    other.setOptionValue("output_flag", False)
    other.readModel(str(path))
    lp = other.getLp()
    sizes = (lp.num_row_, lp.num_col_, len(lp.a_matrix_.value_))
    own = (program.num_rows, program.num_variables, len(program.data))
    assert sizes == own, f"PuLP wrote {sizes} rows, columns and entries, waybound {own}"
    costs = np.asarray(lp.col_cost_)
    if program.sense == "max":  # the sense stands in a comment of PuLP's file, which HiGHS does not read
        costs = np.abs(costs)
    for name, theirs, ours in (
        ("costs", costs, program.cost),
        ("lower bounds", lp.col_lower_, program.lower), ("upper bounds", lp.col_upper_, program.upper),
        ("left sides", lp.row_lower_, program.row_lower), ("right sides", lp.row_upper_, program.row_upper),
        ("coefficients", lp.a_matrix_.value_, program.data),
    ):  # fmt: skip
        assert np.allclose(np.sort(theirs), np.sort(ours), rtol=1e-9, atol=1e-9), f"the {name} differ"


def clocks(run: Callable[[], Any]) -> dict[str, float]:
    """Wall and CPU seconds of one call; ``part`` where it returns a pair, whose second is the seconds that a part of it took."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = run()
    seconds = {"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}
    if isinstance(result, tuple):
        seconds["part"] = result[1]
    return seconds


class Medians:
    """Medians of clocks over runs in fresh processes, in which all meet untouched memory, whose first use is part of the cost."""

    def __init__(self, module: str, options: Sequence[object], contestants: Sequence[str], program: Program, repeats: int) -> None:
        self.runs: dict[str, list[dict[str, float]]] = {name: [] for name in contestants}
        self.heading = f"medians of {repeats} runs (PuLP: {min(repeats, PULP_RUNS)})"
        with tempfile.TemporaryDirectory() as folder:
            for number in range(repeats):  # in turn, so that all meet the same load of the machine
                for name, runs in self.runs.items():
                    if name != "pulp" or number < PULP_RUNS:
                        runs.append(in_a_fresh_process("-m", module, *options, "--once", name, "--folder", folder))
            same_model(program, Path(folder) / MODEL)

    def __call__(self, name: str, clock: str) -> float:
        return statistics.median(run[clock] for run in self.runs[name])


MODEL = "model.mps"
"""The file that PuLP writes."""


def print_clocks(run: Callable[[], Any]) -> None:
    """Measure in this process, after imports and data."""
    print(json.dumps(clocks(run)))
