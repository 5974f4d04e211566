"""Loads that rise and fall, and energy that is filled up on the way, as levels at the nodes of the three-index form.

With X_ij = sum over vehicles of x_ijk, of all types unless it says otherwise, v_i = sum_j X_ij and Q_k the capacity of k, for each load
dimension that is not only delivered or only collected: R_i is what is left to deliver on leaving i, P_i what has been collected,
S_i what shipments have put on board; q_i, p_i and s_i (less where they end) are what i adds::

    undelivered[i,j]  R_i >= R_j + q_j - U (1 - X_ij)             arcs into depots where their vehicle reloads left out
    collected[i,j]    P_j >= P_i + p_j - (U + p_j) (1 - X_ij)     the same arcs;  P_j >= p_j v_j
    shipped[i,j]      S_j >= S_i + s_j - (U + s_j) (1 - X_ij)     all arcs;       S_j >= s_j v_j
    before[j]         R_j + q_j v_j <= sum_k Q_k v_jk             U = largest of the Q_k, or all loads together
    room[i]           R_i + P_i + S_i <= sum_k Q_k v_ik

Residual energy q_i of a type with recharging stations, whose store holds B, and B_0 <= B at departure; f_ij = rate d_ij, D are the
copies of its stations, X_ij counts its vehicles alone::

    residual[i,j]     q_j <= q_i - f_ij + (B + f_ij) (1 - X_ij)   i not in D
    home[i]           q_i >= f_ig X_ig                            i not in D
    filled[j]         q_j <= B - sum_{d in D} f_dj X_dj - (B - B_0 + f_oj) X_oj,   0 <= q_j

Stations are visited any number of times, for each depot on the way has as many copies as there are reasons to stop there, and no arc
between two stations, or from one home, draws more than B. A walk cannot fall apart into pieces around depots, since copies are nodes of
one route, which the time or order rows hold together: rows for connectivity are not needed.

Source: Mitchell (2020), CMU-RI-TR-20-52, (2.7)-(2.12), of which those that forbid to waste energy are left out, being redundant, and
those for depots are written without large constants. As printed, depots are common nodes: a walk may fall apart, and moves between
depots draw nothing. Copies of stations: Schneider, Stenger, Goeke (2014).
"""

import math

import numpy as np
from numpy.typing import NDArray

from ...programs.program import Floats
from ...programs.rows import Ints, Part, rows
from ._vehicles import Drive, VehicleBlocks, VehicleColumns

Loads = tuple[Floats, Floats, Floats]


def add_loads(blocks: VehicleBlocks) -> None:
    """Levels of the load dimensions for which the sum over a route does not say what is on board."""
    sites, fleet = blocks.problem.sites, blocks.problem.fleet
    at = blocks.types[0].prep.sites
    served = np.zeros(len(at))
    served[1 : len(blocks.problem.customers) + 1] = 1.0
    for k in range(sites.dimensions):
        demand = (sites.demand if k == 0 else sites.further_demand[:, k - 1])[at] * served
        pickup = (sites.pickup if k == 0 else sites.further_pickup[:, k - 1])[at] * served
        shipped, total = np.zeros(len(at)), float(demand.sum() + pickup.sum())
        node = {site: i for i, site in enumerate(at.tolist()) if served[i]}
        for s in sites.shipments:
            load = s.load[k] if k < len(s.load) else 0.0
            shipped[node[s.pickup]] += load
            shipped[node[s.delivery]] -= load
            total += load
        capacities = [v.capacities[k] if k < len(v.capacities) else math.inf for v in fleet]
        rises = bool((demand.any() and pickup.any()) or shipped.any())
        if (rises or any(v.reloads for v in fleet)) and total > 0 and not all(map(math.isinf, capacities)):
            _load(blocks, "" if k == 0 else f"-{k + 1}", (demand, pickup, shipped), [min(c, total) for c in capacities])


def _load(blocks: VehicleBlocks, number: str, amounts: Loads, capacities: list[float]) -> None:
    nodes, largest = np.arange(1, blocks.nodes + 1), max(capacities)
    labels, row = (blocks.names,), np.arange(blocks.nodes)
    names = ("undelivered", "collected", "shipped")
    used = [name for name, amount in zip(names, amounts, strict=True) if amount.any()]
    column = {name: blocks.add_columns(name + number, (nodes,), labels, 0.0, largest) for name in used}
    for name, amount in zip(names, amounts, strict=True):
        if name in column:
            _rise(blocks, name, number, amount, column[name], largest)
    room: list[Part] = [(r, c, -capacities[k]) for k, kind in enumerate(blocks.types) for r, c, _ in blocks.visits(nodes, [kind])]
    blocks.rows.append(rows(f"room{number}", blocks.nodes, [*((row, first + row, 1.0) for first in column.values()), *room], upper=0.0,
                          keys=(nodes,), labels=labels))  # fmt: skip
    if "undelivered" in column:
        demand = amounts[0][1:-1]
        before: list[Part] = [
            (r, c, demand[r] - capacities[k]) for k, kind in enumerate(blocks.types) for r, c, _ in blocks.visits(nodes, [kind])
        ]
        parts: list[Part] = [(row, column["undelivered"] + row, 1.0), *before]
        blocks.rows.append(rows(f"before{number}", blocks.nodes, parts, upper=0.0, keys=(nodes,), labels=labels))

    def encode(x: Floats, drives: list[Drive]) -> None:
        for d in drives:
            for name, level in _aboard(d, amounts).items():
                if name in column:
                    x[column[name] + d.nodes[1:-1] - 1] = level

    blocks.encoders.append(encode)


def _rise(blocks: VehicleBlocks, name: str, number: str, amount: Floats, first: int, largest: float) -> None:
    """Rows along arcs between nodes, and the least level at each node."""
    chosen = []
    for kind in blocks.types:
        empties = np.isin(kind.prep.sites[kind.head], kind.vehicle.reloads) if name != "shipped" else np.zeros(len(kind.head), dtype=bool)
        chosen.append((kind, np.nonzero(kind.inner() & ~empties)[0]))
    i, j, row, x = blocks.united(chosen)
    size = np.arange(len(i))
    rising, falling = (i, j) if name == "undelivered" else (j, i)  # the level at the first is the larger
    big = np.maximum(0.0, largest + amount[j])
    parts: list[Part] = [(size, first + rising - 1, 1.0), (size, first + falling - 1, -1.0), (row, x, -big[row])]
    blocks.rows.append(rows(name + number, len(i), parts, lower=amount[j] - big, keys=(i, j), labels=(blocks.names, blocks.names)))
    least = np.nonzero(amount > 0)[0]
    if name != "undelivered" and len(least):
        at = np.arange(len(least))
        parts = [(at, first + least - 1, 1.0), *((r, c, -amount[least][r]) for r, c, _ in blocks.visits(least))]
        blocks.rows.append(rows(f"{name}-least{number}", len(least), parts, lower=0.0, keys=(least,), labels=(blocks.names,)))


def _aboard(d: Drive, amounts: Loads) -> dict[str, Floats]:
    """Levels on leaving each stop."""
    nodes = d.nodes[1:-1]
    empties = np.isin(d.kind.prep.sites[nodes], d.kind.vehicle.reloads) if d.kind.vehicle.reloads else np.zeros(len(nodes), dtype=bool)
    levels = {name: np.zeros(len(nodes)) for name in ("undelivered", "collected", "shipped")}
    undelivered = 0.0
    for at in range(len(nodes) - 1, -1, -1):
        levels["undelivered"][at] = undelivered
        undelivered = 0.0 if empties[at] else undelivered + amounts[0][nodes[at]]
    collected = shipped = 0.0
    for at, node in enumerate(nodes.tolist()):
        collected = 0.0 if empties[at] else collected + amounts[1][node]
        shipped += amounts[2][node]
        levels["collected"][at], levels["shipped"][at] = collected, shipped
    return levels


def add_residual_energy(blocks: VehicleBlocks) -> None:
    """Residual energy of the types that recharge on the way."""
    for number, kind in enumerate(blocks.types):
        if kind.vehicle.stations:
            _residual(blocks, kind, number)


def _residual(blocks: VehicleBlocks, kind: VehicleColumns, number: int) -> None:
    energy, prep, names = kind.vehicle.energy, kind.prep, [v.name for v in blocks.problem.fleet]
    assert energy is not None
    store, nodes = energy.capacity, np.arange(1, blocks.nodes + 1)
    full: NDArray[np.bool_] = np.isin(prep.sites, energy.stations)
    full[[0, -1]] = False
    draws = energy.rate * kind.with_idle(prep.duration, kind.idle_duration)
    first = blocks.add_columns("residual", (nodes, np.full(len(nodes), number)), (blocks.names, names), 0.0, store)

    def keyed(*at: Ints) -> tuple[Ints, ...]:
        return (*at, np.full(len(at[0]), number))

    arcs = np.nonzero(kind.inner() & ~full[kind.tail])[0]
    i, j, f, row = kind.tail[arcs], kind.head[arcs], draws[arcs], np.arange(len(arcs))
    moves: Part = (np.repeat(row, kind.count), kind.together(arcs), np.repeat(store + f, kind.count))
    parts: list[Part] = [(row, first + j - 1, 1.0), (row, first + i - 1, -1.0), moves]
    blocks.rows.append(rows("residual", len(arcs), parts, upper=store, keys=keyed(i, j), labels=(blocks.names, blocks.names, names)))
    arcs = np.nonzero((kind.head == prep.end) & (kind.tail != 0) & ~full[kind.tail])[0]
    i, row = kind.tail[arcs], np.arange(len(arcs))
    parts = [(row, first + i - 1, 1.0), (np.repeat(row, kind.count), kind.together(arcs), -np.repeat(draws[arcs], kind.count))]
    blocks.rows.append(rows("home", len(arcs), parts, lower=0.0, keys=keyed(i), labels=(blocks.names, names)))
    arcs = np.nonzero((kind.head != prep.end) & (full[kind.tail] | (kind.tail == 0)))[0]
    spent = draws[arcs] + np.where(kind.tail[arcs] == 0, store - energy.at_departure, 0.0)
    row = np.arange(blocks.nodes)
    parts = [(row, first + row, 1.0), (np.repeat(kind.head[arcs] - 1, kind.count), kind.together(arcs), np.repeat(spent, kind.count))]
    blocks.rows.append(rows("filled", blocks.nodes, parts, upper=store, keys=keyed(nodes), labels=(blocks.names, names)))

    def encode(x: Floats, drives: list[Drive]) -> None:
        for d in drives:
            level = energy.at_departure
            for node, arc in zip(d.nodes[1:-1].tolist(), d.arcs.tolist(), strict=False):
                level -= energy.rate * float(prep.duration[arc])
                if d.kind is kind:
                    x[first + node - 1] = level
                level = store if full[node] else level

    blocks.encoders.append(encode)
