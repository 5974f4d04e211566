"""VROOM through pyvroom as its own documentation uses it: ``python _bare_vroom.py DATA.npz LEVEL``, see ``_bare_routing``."""

import sys
import time
from typing import Any

import numpy as np
import vroom
from _bare_routing import load, tell  # type: ignore[import-not-found]  # a script's neighbour

d, level = load(sys.argv[1]), int(sys.argv[2])
start = time.process_time()
made = vroom.Input()
made.set_costs_matrix("car", (d["distance"] * d["unit"][0]).astype(np.uint32))
made.set_durations_matrix("car", (d["duration"] if d["timed"] else np.zeros_like(d["duration"])).astype(np.uint32))
limited = bool((d["max_distance"] < 2**32).any())
if limited:
    made.set_distances_matrix("car", d["spanned"].astype(np.uint32))
carried = int(d["demand"].sum() + d["pickup"].sum() + d["shipped"].sum())


def timed(i: int) -> dict[str, Any]:
    if not d["timed"]:
        return {}
    return {"default_service": int(d["service"][i]), "time_windows": [window(d["ready"][i], d["due"][i])]}


def window(opens: int, closes: int) -> vroom.TimeWindow:
    return vroom.TimeWindow(int(opens), int(min(closes, 2**32 - 1)))


others = {*d["depots"].tolist(), *d["shipments"].ravel().tolist()}
made.add_job(
    [
        vroom.Job(i, i, delivery=[int(d["demand"][i])], pickup=[int(d["pickup"][i])], priority=int(d["prize"][i]), **timed(i))
        for i in range(len(d["demand"])) if i not in others and (d["required"][i] or d["prize"][i])
    ]
)  # fmt: skip
for (first, last), amount in zip(d["shipments"].tolist(), d["shipped"].tolist(), strict=True):
    made.add_shipment(
        vroom.ShipmentStep(first, first, **timed(first)), vroom.ShipmentStep(last, last, **timed(last)), vroom.Amount([amount]), set()
    )
made.add_vehicle(
    [
        vroom.Vehicle(
            number, start=int(d["start"][k]), end=int(d["end"][k]), profile="car", costs=vroom.VehicleCosts(fixed=int(d["fixed"][k])),
            capacity=[int(min(d["capacity"][k], carried))], time_window=window(d["opens"][k], d["closes"][k]) if d["timed"] else None,
            **({"max_distance": int(min(d["max_distance"][k], 2**32 - 1))} if limited else {}),
            **({"max_travel_time": int(d["max_duration"][k])} if d["max_duration"][k] < 2**32 and not d["service"].any() else {}),
        )
        for number, k in enumerate(np.repeat(np.arange(len(d["vehicles"])), d["vehicles"]))
    ]
)  # fmt: skip
found = made.solve(exploration_level=level, nb_threads=1)
stops = found.routes[found.routes["type"].isin(["job", "pickup", "delivery"])]
tell([[int(i) for i in part["location_index"]] for _, part in stops.groupby("vehicle_id")], time.process_time() - start)
