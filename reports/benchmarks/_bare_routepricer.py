"""RoutePricer (PathWyse) as its documentation uses it: ``python _bare_routepricer.py DATA.npz REPEATS``; it knows nothing of waybound.

Prints a line of JSON: for each matrix of costs the least CPU seconds of a search, its status there, and the cost of the best route.
"""

import json
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import routepricer  # type: ignore[import-not-found]  # in an environment of its own
from numpy.typing import NDArray

data = np.load(sys.argv[1])
costs, usable, near, time_of, ready, due, demand = (data[key] for key in ("costs", "usable", "near", "time", "ready", "due", "demand"))
nodes = len(usable)  # node 0 is where routes begin; where they end is one more

folder = tempfile.mkdtemp()
os.chdir(folder)  # settings and memories are read from here
kept = np.zeros((nodes + 1, nodes + 1), np.int64)
kept[1:nodes, 1:nodes] = near[1:, 1:]
np.savetxt("kept.csv", kept, fmt="%d", delimiter=",")
settings = {
    "verbosity": 0, "problem/decimal_digits": 0, "algo_names": "PWDefault", "algo/default/ng": "standard", "algo/default/dssr": "off",
    "algo/default/ng/set_path": "kept.csv", "algo/default/ng/set_size": int(near.sum(axis=1).max()),
}  # fmt: skip
Path("pathwyse.set").write_text("".join(f"{name} = {value}\n" for name, value in settings.items()))


def searched(cost: NDArray[np.int64]) -> tuple[float, int, int]:
    """CPU seconds, status and cost of one search."""
    solver = routepricer.PWSolver()
    solver.createProblem()
    solver.setNumNodes(nodes + 1)
    solver.setDirected(True)
    solver.setCyclic(True)
    solver.setOrigin(0)
    solver.setDestination(nodes)
    solver.initProblem()
    clock, load = solver.addResource("TW"), solver.addResource("CAP")
    solver.setResBounds(load, 0, int(data["capacity"]))
    for i, j in np.argwhere(usable).tolist():
        head = j or nodes
        solver.addArc(i, head)
        solver.setArcCost(i, head, int(cost[i, j]))
        solver.setResArcConsumption(clock, i, head, int(time_of[i, j]))
    for node in range(nodes + 1):
        at = node % nodes
        first, last = (0, 0) if node == 0 else (int(ready[at]), int(due[at]))
        solver.setResNodeBound(clock, node, first, last)
        solver.setResNodeConsumption(load, node, int(demand[at]))
    solver.buildProblem()
    solver.setupAlgorithms()
    began = time.process_time()
    solver.solve()
    seconds = time.process_time() - began
    return seconds, solver.getSolutionStatus(0), solver.getSolutionObjective(0)


rows = []
for cost in costs:
    runs = [searched(cost) for _ in range(int(sys.argv[2]))]
    rows.append([min(run[0] for run in runs), *runs[0][1:]])
print(json.dumps({"version": routepricer.__version__, "rows": rows}))
