"""All solvers against a brute force on random instances of up to 7 customers; every certificate is verified again.

Run as ``python -m waybound.reports.benchmarks.small_cases [--instances 200] [--seed 1]``. Exits with 1 on any disagreement
beyond 1e-6.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import sys
import time
from collections import defaultdict

import numpy as np

from waybound.formulations.certificate import check_certificate
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.solving.solve import solve

SOLVERS: dict[str, dict[str, object]] = {
    "highs": {"time_limit": 60.0},
    "pulp": {"time_limit": 60.0},
    "ortools": {"time_limit": 20.0, "iterations": 300},
    "pyvrp": {"time_limit": 20.0, "iterations": 500},
}


def random_problem(rng: np.random.Generator, number: int) -> RoutingProblem:
    """A small capacitated problem; every other one has windows and service times, every third is truncated."""
    n = int(rng.integers(1, 8))
    xy = rng.uniform(0, 50, (n + 1, 2)).round(int(rng.integers(0, 3)))
    windows = number % 2 == 0
    opens = rng.uniform(0, 120, n + 1).round(1) if windows else np.zeros(n + 1)
    width = rng.uniform(10, 80, n + 1).round(1) if windows else np.full(n + 1, math.inf)
    opens[0], width[0] = 0.0, math.inf
    demand = rng.integers(0, 10, n + 1).astype(float)
    demand[0] = 0.0
    sites = Sites.of(
        range(n + 1), demand=demand, ready=opens, due=opens + width, service=np.r_[0.0, rng.uniform(0, 5, n).round(1)] if windows else 0.0
    )
    travel = Travel("euclidean", coordinates=xy, convention="trunc1" if number % 3 == 0 else "exact")
    count = int(rng.integers(1, n + 2))
    capacity = float(max(demand.max(), math.ceil(demand.sum() / count * rng.uniform(1.0, 1.6))))
    return RoutingProblem(sites, travel, (VehicleType(count=count, capacity=capacity),), name=f"random-{number}")


def brute_force(problem: RoutingProblem) -> float:
    """Least cost by enumerating every order of every subset, then every partition; infinite if there is none."""
    sites, vehicle = problem.sites, problem.fleet[0]
    d = problem.travel.distances.tolist()
    n = len(sites) - 1
    demand, ready, due, service = (getattr(sites, k).tolist() for k in ("demand", "ready", "due", "service"))
    cheapest: dict[int, float] = defaultdict(lambda: math.inf)
    for size in range(1, n + 1):
        for order in itertools.permutations(range(1, n + 1), size):
            if sum(demand[i] for i in order) > vehicle.capacity + 1e-9:
                continue
            clock, cost, at = ready[0], 0.0, 0
            for to in order:
                clock = max(clock + service[at] + d[at][to], ready[to])
                cost += d[at][to]
                if clock > due[to] + 1e-9:
                    break
                at = to
            else:
                if clock + service[at] + d[at][0] <= due[0] + 1e-9:
                    key = sum(1 << (i - 1) for i in order)
                    cheapest[key] = min(cheapest[key], cost + d[at][0])
    best = {0: 0.0}
    for _ in range(vehicle.count or n):
        grown = dict(best)
        for done, cost in best.items():
            for subset, price in cheapest.items():
                if not subset & done and cost + price < grown.get(subset | done, math.inf):
                    grown[subset | done] = cost + price
        best = grown
    return best.get((1 << n) - 1, math.inf)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--instances", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--solvers", nargs="*", default=list(SOLVERS))
    chosen = parser.parse_args()
    rng = np.random.default_rng(chosen.seed)
    problems = [random_problem(rng, k) for k in range(chosen.instances)]
    optima = [brute_force(p) for p in problems]
    feasible = sum(math.isfinite(v) for v in optima)
    print(f"{len(problems)} instances, {feasible} feasible; brute force against {', '.join(chosen.solvers)}")
    failures = 0
    for name in chosen.solvers:
        began, agree, proved, verified = time.perf_counter(), 0, 0, 0
        for problem, optimum in zip(problems, optima, strict=True):
            solution = solve(problem, name, bound_time=1.0, **SOLVERS[name])  # type: ignore[arg-type]
            value = solution.objective if isinstance(solution.objective, float) else math.inf
            same = value == optimum if math.isinf(optimum) else abs(value - optimum) <= 1e-6
            agree += same
            proved += solution.status in ("optimal", "infeasible")
            if not same:
                print(f"  {name} on {problem.name}: {value!r}, brute force {optimum!r}, status {solution.status} {solution.message}")
            # What a certificate file holds, read back and verified without a solver.
            written = json.loads(json.dumps(solution.certificate.to_json(with_evidence=True)))
            evaluation = None if solution.answer is None else problem.evaluate(solution.answer)
            made = check_certificate(problem, written, evaluation)
            verified += made.infeasible if made.bound is None else made.bound <= optimum + 1e-6
        seconds = time.perf_counter() - began
        failures += len(problems) - agree
        print(
            f"{name:8s} agrees on {agree}/{len(problems)}; says optimal or infeasible on {proved}; "
            f"certificates that prove a bound or that there is no answer {verified}; {seconds:.1f} s"
        )
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
