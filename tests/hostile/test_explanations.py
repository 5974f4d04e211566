"""What ``explain`` and the proofs of infeasibility say is true, on random instances, by brute force that shares no code with them.

Sites that coincide, distances and service of zero, ties, tight windows, asymmetric matrices without the triangle inequality, mixed
fleets from several depots, all four ways of charging energy, limits on duration and distance, least numbers of routes, optional sites.
"""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from truth import routing as exact_routing

import waybound as wb
from waybound import Energy, Evidence, Program, RoutingProblem, Rows, Sites, Variables, VehicleType
from waybound.formulations.routing.fleet_need import fleet_conflicts, suspicions
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.bounds.routing.infeasibility import fleet_need_evidence, infeasible_site_evidence, too_few_vehicles_evidence
from waybound.solving.explaining import explain, reasons_from_data

CHARGES = ("travel", "elapsed", "elapsed-fixed-start", "windows")


# -- instances ---------------------------------------------------------------------------------------------------------


def draw(seed: int, sites_more: int = 0) -> RoutingProblem:
    """3 to 6 sites, and more if asked for; every number is a multiple of 0.1, so that nothing hangs on rounding."""
    rng = np.random.default_rng([seed, 815])
    chance = lambda p: bool(rng.random() < p)  # noqa: E731
    depots = 2 if chance(0.25) else 1
    n = max(int(rng.integers(3, 7)), depots + 1) + sites_more
    depot = np.zeros(n, dtype=bool)
    depot[rng.permutation(n)[:depots]] = True
    at = np.nonzero(depot)[0]
    roomy = 16 if chance(0.6) else 0  # sites can be served alone, so that it is the fleet that fails
    step = float(rng.choice([1.0, 0.1, 7.0, 1000.0], p=[0.6, 0.2, 0.1, 0.1]))
    if chance(0.5):
        matrix = rng.choice([0, 0, 1, 2, 3, 5, 9], (n, n)) * step
        durations = rng.choice([0, 1, 1, 2, 4, 8], (n, n)) * step if chance(0.4) else None
        travel = Travel(EXPLICIT, matrix=matrix, duration_matrix=durations)
    else:
        xy = rng.integers(0, 4, (n, 2)) * step
        if chance(0.3):
            xy[1:] = xy[rng.integers(0, n, n - 1)]
        travel = Travel("euclidean" if chance(0.5) else "manhattan", xy, convention="exact" if chance(0.6) else "round")
    service = np.where(depot, 0, rng.integers(0, 4, n)) * step if chance(0.5) else np.zeros(n)
    ready, due = np.zeros(n), np.full(n, math.inf)
    if chance(0.7):
        ready = rng.integers(0, 12, n) * step
        due = ready + (rng.choice([0, 1, 2, 4, 8, 20], n) + roomy * (rng.random(n) < 0.8)) * step
        if chance(0.5):
            due[rng.random(n) < 0.3] = math.inf
        ready[depot], due[depot] = rng.integers(0, 3, depots) * step, (rng.choice([8, 15, 30, math.inf], depots) + roomy) * step
        due[depot] = np.maximum(due[depot], ready[depot])
    demand = np.where(depot, 0, rng.integers(roomy // 4, 7 + roomy // 3, n)) * step
    required = ~depot & (rng.random(n) < 0.7 if chance(0.3) else True)
    fleet = []
    for kind in range(int(rng.choice([1, 2, 3], p=[0.65, 0.25, 0.1]))):
        limit = lambda p, low, high: float(rng.integers(low, high) + roomy // 2) * step if chance(p) else math.inf  # noqa: E731
        energy = None
        if chance(0.25):
            rate = float(rng.choice([0.5, 1.0, 2.0]))
            energy = Energy(float(rng.integers(2, 25) + roomy) * step * rate, rate, str(rng.choice(CHARGES)))
        fleet.append(
            VehicleType(
                None if chance(0.25) else 1 if roomy else int(rng.integers(1, 4)), limit(0.6, 4, 14),
                int(rng.choice(at)), int(rng.choice(at)), limit(0.25, 4, 30), limit(0.25, 3, 25), energy, name=f"kind{kind}",
            )
        )  # fmt: skip
    counts = [v.count for v in fleet]
    most = n if None in counts else sum(c or 0 for c in counts)
    least = int(rng.integers(1, most + 1)) if chance(0.2) else 0
    sites = Sites.of(
        [f"s{k}" for k in range(n)], depot=depot, demand=demand, ready=ready, due=due, service=service, required=required
    )  # fmt: skip
    return RoutingProblem(sites, travel, tuple(fleet), min_vehicles=least)


# -- brute force -------------------------------------------------------------------------------------------------------


def routes(problem: RoutingProblem, vehicle: VehicleType) -> set[frozenset[int]]:
    """Sets of sites that one vehicle can serve on a route, by trying every order."""
    return {frozenset(visits) for visits in exact_routing.routes(problem, vehicle)}


def has_answer(problem: RoutingProblem, tables: list[set[frozenset[int]]], required: set[int], least: int) -> bool:
    """Whether disjoint routes serve ``required``, with no more vehicles than there are and at least ``least`` routes."""

    def go(left: frozenset[int], used: tuple[int, ...]) -> bool:
        if not left:
            return sum(used) >= least
        first = min(left)
        if first not in required and go(left - {first}, used):
            return True
        for kind, table in enumerate(tables):
            count = problem.fleet[kind].count
            if count is None or used[kind] < count:
                more = tuple(u + (k == kind) for k, u in enumerate(used))
                if any(first in group and group <= left and go(left - group, more) for group in table):
                    return True
        return False

    return go(frozenset(problem.customers.tolist()), (0,) * len(tables))


def feasible(problem: RoutingProblem, tables: list[set[frozenset[int]]] | None = None) -> bool:
    tables = [routes(problem, v) for v in problem.fleet] if tables is None else tables
    return has_answer(problem, tables, set(np.nonzero(problem.sites.required)[0].tolist()), problem.min_vehicles)


def is_true(problem: RoutingProblem, tables: list[set[frozenset[int]]], found: Evidence) -> bool:
    """Whether the claim of ``found`` holds taken by itself."""
    index, every = problem.sites.index(), set().union(*tables)
    most = len(problem.customers)  # no more routes than sites
    counts = [most if v.count is None else min(v.count, most) for v in problem.fleet]
    required = set(np.nonzero(problem.sites.required)[0].tolist())
    named = {index[name] for name in found.data.get("sites", [])}
    if found.kind == "infeasible-site":
        site = index[found.data["site"]]
        return site in required and not any(site in group for group in every)
    if found.kind == "sites-apart":
        able = sum(c for c, table in zip(counts, tables, strict=True) if any(group & named for group in table))
        return named <= required and len(named) > able and not any(len(group & named) > 1 for group in every)
    if found.kind == "sites-beyond-fleet":
        rest = set().union(*every) - named
        return not has_answer(problem, tables, required & named, 0 if rest else problem.min_vehicles)
    if found.kind == "too-few-sites":
        return problem.min_vehicles > len(set().union(*every))
    if found.kind == "too-few-vehicles":
        return sum(problem.sites.demand[list(required)]) > sum(c * v.capacity for c, v in zip(counts, problem.fleet, strict=True))
    open_sites = replace(problem.sites, due=np.where(problem.sites.depot, problem.sites.due, math.inf))
    plain = [VehicleType(v.count, math.inf, v.start, v.end) for v in problem.fleet]
    if found.kind == "too-little-time":
        by_time = replace(problem, fleet=tuple(plain))
        return not has_answer(by_time, [routes(by_time, v) for v in plain], required & named, 0)
    if found.kind == "bin-packing":
        alike = [replace(v, capacity=max(v.capacity for v in problem.fleet)) for v in plain]
        far_due = replace(open_sites, due=np.full(len(problem.sites), math.inf))
        return not feasible(replace(problem, sites=far_due, fleet=tuple(alike), min_vehicles=0))
    assert found.kind == "too-little-range"
    limits = ("max_distance",) if found.data["resource"] == "distance" else ("max_duration", "energy")
    bounded = tuple(replace(p, **{k: getattr(v, k) for k in limits}) for p, v in zip(plain, problem.fleet, strict=True))
    return not feasible(replace(problem, sites=open_sites, fleet=bounded, min_vehicles=0))


def proves(problem: RoutingProblem, found: Evidence) -> bool:
    return verified_bound(problem, found) == math.inf


# -- the attacks -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("part", range(4))
def test_reasons_of_random_routing_instances_are_true(share, tally, part):
    cases = share(160, 10_000) // 4
    for seed in range(part * cases, (part + 1) * cases):
        problem = draw(seed)
        tables = [routes(problem, v) for v in problem.fleet]
        solvable = feasible(problem, tables)
        reasons = list(reasons_from_data(problem))
        tally["routing instances explained"] += 1
        tally["routing instances without an answer"] += not solvable
        tally["of them with a checked reason"] += bool(reasons)
        assert bool(reasons) != solvable, (seed, reasons)  # at this size every choice of routes is tried: none goes unexplained
        for reason in reasons:
            assert reason.evidence is not None
            assert proves(problem, reason.evidence), (seed, reason)
            assert is_true(problem, tables, reason.evidence), (seed, reason)
            tally[f"reasons: {reason.evidence.kind}"] += 1
        for find in (infeasible_site_evidence, too_few_vehicles_evidence, fleet_need_evidence):
            found = find(problem, Stop(10.0))
            if found is not None:
                assert not solvable, (seed, found)
                assert is_true(problem, tables, found), (seed, found)
                tally["proofs before a search"] += 1


def test_groups_of_few_sites_are_to_blame_among_more(share, tally):
    """Where more sites than are enumerated: detours over the others are free to be taken."""
    for seed in range(share(12, 150)):
        problem = draw(3 * 10**6 + seed, sites_more=2)
        tables = [routes(problem, v) for v in problem.fleet]
        for found in fleet_conflicts(problem, most_enumerated=4):
            assert is_true(problem, tables, found), (seed, found)
            tally[f"reasons among more sites: {found.kind}"] += 1


def test_no_evidence_whatever_it_names_proves_what_is_false(share, tally):
    for seed in range(share(30, 1_000)):
        problem = draw(10**6 + seed)
        tables = [routes(problem, v) for v in problem.fleet]
        solvable = feasible(problem, tables)
        rng = np.random.default_rng(seed)
        customers = [problem.sites.ids[k] for k in problem.customers]
        tried = list(suspicions(problem))
        tried += [Evidence(kind, "", math.inf, {}) for kind in ("too-few-vehicles", "too-few-sites")]
        tried += [Evidence("too-little-range", "", math.inf, {"resource": r}) for r in ("travel", "duration", "distance")]
        tried += [Evidence("bin-packing", "", math.inf, {"threshold": float(k)}) for k in rng.choice([0, 0.1, 1, 2, 3, 1000], 3)]
        tried += [Evidence("infeasible-site", "", math.inf, {"site": name}) for name in customers]
        for kind in ("sites-apart", "sites-beyond-fleet"):
            for _ in range(3):
                names = rng.permutation(customers)[: rng.integers(1, len(customers) + 1)].tolist()
                tried.append(Evidence(kind, "", math.inf, {"sites": names}))
        for _ in range(3):
            named = rng.permutation(problem.customers)[: rng.integers(1, len(customers) + 1)]
            s, moves = problem.sites, problem.travel.durations
            first = min(max(s.ready[j], s.ready[v.start] + moves[v.start, j]) for j in named for v in problem.fleet)
            span = {"from": float(first), "until": float(min(1e6, s.due[named].max()))}
            tried.append(Evidence("too-little-time", "", math.inf, {"sites": [s.ids[j] for j in named], **span}))
        for found in tried:
            tally["evidence tried on the checkers"] += 1
            if proves(problem, found):
                tally[f"accepted: {found.kind}"] += 1
                assert not solvable, (seed, found)
                assert is_true(problem, tables, found), (seed, found)


def test_whole_explanations_of_random_routing_instances_are_true(share, tally):
    for seed in range(share(2, 100)):
        problem = draw(2 * 10**6 + seed)
        made = explain(problem, time_limit=4.0)
        tally[f"explanations: {made.verdict}" + (f", according to {made.according_to}" if made.according_to else "")] += 1
        if made.according_to == "the data":
            assert (made.verdict == "feasible") == feasible(problem), (seed, made)


def test_explanations_of_other_families_are_true(share, tally):
    """Nobody has to act, be chosen or take a share: max-min and selection problems always have an answer."""
    for seed in range(share(2, 100)):
        rng = np.random.default_rng([seed, 4711])
        sata = {"robots": int(rng.integers(1, 5)), "actions": 2, "targets": int(rng.integers(1, 8)), "phi": 100.0}
        asked = [wb.generate("sata", problem=name, seed=seed, **sata) for name in ("bottleneck", "bottleneck-lp", "winner-takes-all")]
        constraint = str(rng.choice(["cardinality", "partition", "knapsack"]))
        asked.append(wb.generate("coverage", elements=int(rng.integers(2, 9)), items=6, constraint=constraint, seed=seed))
        scale = float(rng.choice([1.0, 1e-11, 1e9]))
        packing, covering = (rng.integers(0, 4, (3, 4)) + np.eye(3, 4, k) for k in (0, 1))
        asked.extend(wb.MaxMinLP(packing + (packing.sum(axis=0) == 0), (covering + np.eye(3, 4)) * scale, sense=s) for s in ("max", "min"))
        for problem in asked:
            made = explain(problem, time_limit=5.0)
            tally[f"explanations of other families: {made.verdict}, according to {made.according_to or 'nobody'}"] += 1
            assert made.verdict == "feasible", (seed, problem, made)


def small_program(seed: int) -> Program:
    """Three whole variables from 0 to 3 and up to five rows."""
    rng = np.random.default_rng([seed, 99])
    m = int(rng.integers(1, 6))
    table, low = rng.integers(-3, 4, (m, 3)).astype(float), rng.integers(-4, 9, m).astype(float)
    block = Rows(
        "row", (np.arange(m),), indptr=np.arange(0, 3 * m + 1, 3).astype(np.int32), indices=np.tile(np.arange(3), m).astype(np.int32),
        data=table.ravel(), lower=low, upper=low + rng.choice([0, 1, math.inf], m),
    )  # fmt: skip
    x = Variables("x", (np.arange(3),), lower=np.zeros(3), upper=np.full(3, 3.0), cost=np.ones(3), integer=True)
    return Program("drawn", "min", (x,), (block,))


def test_explanations_of_bare_programs_say_whose_word_they_are(share, tally):
    grid = np.array(list(itertools.product(range(4), repeat=3)), dtype=float)
    for seed in range(share(24, 1_000)):
        program = small_program(seed)
        values = grid @ program.matrix.toarray().T
        held = (values >= program.row_lower) & (values <= program.row_upper)
        made = explain(program, time_limit=5.0)
        assert made.verdict in ("feasible", "infeasible")
        tally[f"programs: {made.verdict}, according to {made.according_to}"] += 1
        if made.according_to == "the data":
            assert (made.verdict == "feasible") == bool(held.all(axis=1).any()), seed
        elif (made.verdict == "feasible") != bool(held.all(axis=1).any()):
            tally["programs: false words of a solver, said to be its own"] += 1
        if made.reasons:
            named = [int(r.where.split("[")[1][:-1]) for r in made.reasons]
            assert set(named) <= set(range(program.num_rows))
            tally["programs: rows named that have a whole point after all"] += bool(held[:, named].all(axis=1).any())
