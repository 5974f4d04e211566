"""PyVRP as its own documentation uses it: ``python _bare_pyvrp.py DATA.npz WORK [SEED]``, iterations or, as in ``30s``, seconds.

See ``_bare_routing``.
"""

import sys
import time

import pyvrp
from _bare_routing import load, tell  # type: ignore[import-not-found]  # a script's neighbour

d, work, seed = load(sys.argv[1]), sys.argv[2], int([*sys.argv[3:], "1"][0])
start = time.process_time()
ends = set(d["shipments"].ravel().tolist())
depots = d["depots"].tolist()
sites = [i for i in range(len(d["demand"])) if i not in ends and i not in depots]


def window(i: int) -> tuple[int, int]:
    return int(d["ready"][i]), int(d["due"][i])


clients = [
    pyvrp.Client(
        i, delivery=[int(d["demand"][i])], pickup=[int(d["pickup"][i])], service_duration=int(d["service"][i]), tw_early=window(i)[0],
        tw_late=window(i)[1], prize=int(d["prize"][i]), required=bool(d["required"][i]),
    )
    for i in sites
]  # fmt: skip
shipments = [
    pyvrp.Shipment(p, q, *window(p), int(d["service"][p]), *window(q), int(d["service"][q]), amount=[int(load)])
    for (p, q), load in zip(d["shipments"].tolist(), d["shipped"], strict=True)
]
vehicles = [
    pyvrp.VehicleType(
        num_available=int(d["vehicles"][k]), capacity=[int(d["capacity"][k])], start_depot=depots.index(d["start"][k]),
        end_depot=depots.index(d["end"][k]), fixed_cost=int(d["fixed"][k]), tw_early=int(d["opens"][k]), tw_late=int(d["closes"][k]),
        shift_duration=int(d["max_duration"][k]), max_distance=int(d["max_distance"][k]), unit_distance_cost=int(d["unit"][k]),
    )
    for k in range(len(d["vehicles"]))
]  # fmt: skip
data = pyvrp.ProblemData(
    [pyvrp.Location(float(x), float(y)) for x, y in d["xy"]], clients, [pyvrp.Depot(i) for i in depots], vehicles,
    [d["distance"]], [d["duration"]], shipments=shipments,
)  # fmt: skip
end = pyvrp.stop.MaxRuntime(float(work[:-1])) if work.endswith("s") else pyvrp.stop.MaxIterations(int(work))
result = pyvrp.solve(data, end, seed=seed, collect_stats=False, display=False)


def site(activity: pyvrp.Activity) -> int:
    if activity.is_client():
        return int(sites[activity.idx])
    return int(d["shipments"][activity.idx][0 if activity.is_pickup() else 1])


tell([[site(a) for a in route.schedule()[1:-1]] for route in result.best.routes()], time.process_time() - start)
