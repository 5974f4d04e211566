"""OR-Tools' routing library as its own documentation uses it: ``python _bare_ortools.py DATA.npz SOLUTIONS``, see ``_bare_routing``."""

import sys
import time

import numpy as np
from _bare_routing import UNLIMITED, load, tell  # type: ignore[import-not-found]  # a script's neighbour
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

d, solutions = load(sys.argv[1]), int(sys.argv[2])
start = time.process_time()
kind = np.repeat(np.arange(len(d["vehicles"])), d["vehicles"])
n, fleet = len(d["demand"]), range(len(kind))
of_fleet = {
    name: d[name][kind] for name in ("start", "end", "capacity", "fixed", "unit", "opens", "closes", "max_duration", "max_distance")
}
customers = [i for i in range(n) if i not in d["depots"]]
manager = pywrapcp.RoutingIndexManager(n, len(kind), of_fleet["start"].tolist(), of_fleet["end"].tolist())
model = pywrapcp.RoutingModel(manager)
model.SetArcCostEvaluatorOfAllVehicles(model.RegisterTransitMatrix((d["distance"] * d["unit"][0]).tolist()))
for vehicle in fleet:
    model.SetFixedCostOfVehicle(int(of_fleet["fixed"][vehicle]), vehicle)
for i in customers:
    if not d["required"][i]:
        model.AddDisjunction([manager.NodeToIndex(i)], int(d["prize"][i]))

change = d["pickup"] - d["demand"]
for (first, last), amount in zip(d["shipments"].tolist(), d["shipped"].tolist(), strict=True):
    change[first] += amount
    change[last] -= amount
carried = int(d["demand"].sum() + d["pickup"].sum() + d["shipped"].sum())
if carried and (d["capacity"] != UNLIMITED).any():
    room = np.minimum(of_fleet["capacity"], carried).tolist()
    delivered = model.RegisterUnaryTransitVector(d["demand"].tolist())
    if d["pickup"].any():  # what is on board at first is what will be delivered
        model.AddDimensionWithVehicleCapacity(model.RegisterUnaryTransitVector(change.tolist()), 0, room, False, "on board")
        model.AddDimensionWithVehicleCapacity(delivered, 0, room, True, "delivered")
        board, total = model.GetDimensionOrDie("on board"), model.GetDimensionOrDie("delivered")
        for vehicle in fleet:
            model.solver().Add(board.CumulVar(model.Start(vehicle)) == total.CumulVar(model.End(vehicle)))
    elif len(d["shipments"]):
        model.AddDimensionWithVehicleCapacity(model.RegisterUnaryTransitVector(change.tolist()), 0, room, True, "on board")
    else:
        model.AddDimensionWithVehicleCapacity(delivered, 0, room, True, "load")
if (d["max_distance"] != UNLIMITED).any():
    limits = np.minimum(of_fleet["max_distance"], int(2 * n * d["distance"].max())).tolist()
    model.AddDimensionWithVehicleCapacity(model.RegisterTransitMatrix(d["distance"].tolist()), 0, limits, True, "distance")
if d["span"]:
    longest = int(d["spanned"].max(axis=1).sum())
    model.AddDimension(model.RegisterTransitMatrix(d["spanned"].tolist()), 0, longest, True, "span")
    model.GetDimensionOrDie("span").SetGlobalSpanCostCoefficient(int(d["span"]))
if d["timed"]:
    moves = d["service"][:, None] + d["duration"]
    horizon = int(max(d["ready"].max(), d["opens"].max()) + moves.max(axis=1).sum())
    model.AddDimension(model.RegisterTransitMatrix(moves.tolist()), horizon, horizon, False, "time")
    clock = model.GetDimensionOrDie("time")
    for i in customers:
        clock.CumulVar(manager.NodeToIndex(i)).SetRange(int(d["ready"][i]), min(int(d["due"][i]), horizon))
    for vehicle in fleet:
        opens, closes = int(of_fleet["opens"][vehicle]), min(int(of_fleet["closes"][vehicle]), horizon)
        clock.CumulVar(model.Start(vehicle)).SetRange(opens, closes)
        clock.CumulVar(model.End(vehicle)).SetRange(0, closes)
        if of_fleet["max_duration"][vehicle] != UNLIMITED:
            clock.SetSpanUpperBoundForVehicle(int(min(of_fleet["max_duration"][vehicle], horizon)), vehicle)
if len(d["shipments"]):
    model.AddConstantDimension(1, n + 2, True, "position")
    position = model.GetDimensionOrDie("position")
    for pair in d["shipments"].tolist():
        first, last = map(manager.NodeToIndex, pair)
        model.AddPickupAndDelivery(first, last)
        model.solver().Add(model.VehicleVar(first) == model.VehicleVar(last))
        model.solver().Add(position.CumulVar(first) <= position.CumulVar(last))

first, searches = routing_enums_pb2.FirstSolutionStrategy, routing_enums_pb2.LocalSearchMetaheuristic
rewarded = bool(d["prize"].any())
parameters = pywrapcp.DefaultRoutingSearchParameters()
parameters.first_solution_strategy = first.PATH_CHEAPEST_ARC if rewarded else first.PARALLEL_CHEAPEST_INSERTION
guided = bool(d["unit"].any()) and not rewarded
parameters.local_search_metaheuristic = searches.GUIDED_LOCAL_SEARCH if guided else searches.TABU_SEARCH
parameters.time_limit.FromSeconds(3600)
parameters.solution_limit = solutions
model.solver().ReSeed(1)
answer = model.SolveWithParameters(parameters)
routes = []
for vehicle in fleet:
    at, visits = answer.Value(model.NextVar(model.Start(vehicle))), []
    while not model.IsEnd(at):
        visits.append(manager.IndexToNode(at))
        at = answer.Value(model.NextVar(at))
    if visits:
        routes.append(visits)
tell(routes, time.process_time() - start)
