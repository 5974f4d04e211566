"""What the compile benchmarks share: fresh processes, clocks, and the check that two models are the same."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from waybound.formulations.programs.program import Program


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


def timed(run: Callable[[], Any]) -> dict[str, float]:
    """Wall and CPU seconds of one call; ``part`` where it returns a pair, whose second is the seconds that a part of it took."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = run()
    seconds = {"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}
    if isinstance(result, tuple):
        seconds["part"] = result[1]
    return seconds


def in_a_fresh_process(module: str, *arguments: object) -> dict[str, float]:
    """The JSON that ``python -m module`` prints; in a new interpreter all meet untouched memory, whose first use is part of the cost."""
    command = [sys.executable, "-m", module, *map(str, arguments)]
    return dict(json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout))
