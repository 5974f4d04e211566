"""Signals at random instants: whatever searches ends within two seconds, and leaves its best answer and nothing else."""

import itertools
import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

import waybound as wb
from waybound.formulations.certificate import check_certificate
from waybound.formulations.certificate_files import read_certificate
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance
from waybound.solvers.backend import BACKENDS
from waybound.solvers.interrupts import PATIENCE

COMMAND = [sys.executable, "-m", "waybound"]
PARTS, FEW = 4, 2
"""Parts that share the instants, and of how many the fast suite has one."""
SETTLE = 2.0
"""Seconds after which nothing is left of a command that was killed, when it could not end its children itself."""

FILES = {
    "routes.txt": ("solomon", "customers=60"),
    "large.vrp": ("uchoa", "customers=2500"),
    "tour.json": ("random", "customers=3000", "capacity=0", "vehicles=1"),
    "even.json": ("random", "customers=3000", "capacity=0", "vehicles=20"),
    "outing.json": ("random", "customers=3000", "capacity=0", "vehicles=20"),
    "risks.json": ("random", "customers=400", "capacity=0", "deviation=0.3", "max-duration=400"),
    "careful.json": ("random", "customers=25", "capacity=0", "deviation=0.3", "max-duration=400", "vehicles=6"),
    "few.json": ("coverage", "elements=28", "items=1000", "constraint=cardinality", "k=9"),
    "cardinality.json": ("coverage", "elements=3000", "items=8000", "constraint=cardinality", "k=600"),
    "partition.json": ("coverage", "elements=3000", "items=8000", "constraint=partition"),
    "knapsack.json": ("coverage", "elements=300", "items=1000", "constraint=knapsack"),
    "sata.json": ("sata", "robots=40", "actions=10", "targets=200"),
    "crowd.json": ("sata", "robots=300", "actions=10", "targets=1500"),
    "sensing.json": ("sensing-geometric", "robots=20000"),
    "map.json": ("risky-grid", "rows=60", "columns=60", "mud=0.3", "tether=true"),
    "rewards.json": ("risky-grid", "rows=20", "columns=20", "rewards=200"),
    "roadmap.json": ("prm-graph", "vertices=3000"),
    "pairs.json": ("assignment", "robots=2000", "bins=2000", "costs=euclidean"),
    "largest.json": ("assignment", "robots=2000", "bins=2000"),
    "tasks.json": ("robot-tasks", "robots=5", "tasks=16"),
    "shares.json": ("robot-tasks", "robots=5", "tasks=16", "weight=20"),
    "many-tasks.json": ("robot-tasks", "robots=30", "tasks=2000"),
    "many-shares.json": ("robot-tasks", "robots=30", "tasks=2000", "weight=20"),
    "jobs.json": ("generalised-assignment", "agents=40", "jobs=2000", "costs=d"),
    "profits.json": ("generalised-assignment", "agents=60", "jobs=5000", "costs=orchard", "horizon=20000"),
    "errands.json": ("joint-assignment", "robots=1000", "home=1000", "bins=1000", "requests=20", "rows=100", "columns=100"),
    "rooms.json": ("exploration-map", "rooms=500", "robots=50", "steps=1000", "silence=20"),
    "day.json": ("orchard-day", "rows=5", "columns=10", "robots=4", "groups=4"),
    "plan.json": ("risk-allocation", "family=corridor", "steps=100", "constraints=4"),
    "joint-plan.json": ("risk-allocation", "family=corridor", "steps=15", "constraints=4", "risk=joint"),
    "likely-plan.json": ("risk-allocation", "family=corridor", "steps=15", "constraints=4", "risk=joint", "total=0.3"),
    "obstacles.json": ("risk-allocation", "family=obstacles", "steps=12"),
}
"""What keeps the methods below busy for long: generators and their settings."""


def outing(instance: Any) -> Any:
    """Nobody has to be visited, and no route is long."""
    n = len(instance.sites)
    sites = replace(instance.sites, required=np.zeros(n, dtype=bool), reward=np.ones(n))
    return replace(instance, objective=("reward",), sites=sites, fleet=(replace(instance.fleet[0], max_distance=300.0),))


CHANGED = {
    "even.json": lambda instance: replace(instance, objective=("longest-route",)), "outing.json": outing,
    "risks.json": lambda instance: replace(instance, team_risk=0.05),
    "careful.json": lambda instance: replace(instance, fleet=(replace(instance.fleet[0], risk=0.05),)),
    **dict.fromkeys(("shares.json", "many-shares.json"), lambda instance: replace(instance, problem="balanced-partition")),
    "largest.json": lambda instance: replace(instance, problem="bottleneck-assignment"),
}  # fmt: skip

SOLVED = {
    "cpsat": "routes.txt", "highs": "routes.txt", "scip": "routes.txt", "mathopt": "routes.txt", "mathopt:gscip": "knapsack.json",
    "mathopt:highs": "routes.txt", "mathopt:cp-sat": "knapsack.json", "mathopt:glop": "sensing.json", "mathopt:pdlp": "sensing.json",
    "cvxpy": "sensing.json", "cvxpy:CLARABEL": "sensing.json", "cvxpy:SCS": "sensing.json", "cvxpy:HIGHS": "sata.json",
    "pulp": "routes.txt", "pulp:CBC": "knapsack.json", "pulp:HiGHS": "routes.txt", "pyvrp": "routes.txt", "ortools": "routes.txt",
    "portfolio": "routes.txt", "vrpsolver": "routes.txt", "branch-price-cut": "routes.txt",
    "ruin-recreate": "routes.txt",
    "saddle": "sensing.json", "vroom": "large.vrp", "risk-labels": "rewards.json", "path-enumeration": "rewards.json",
    "convex-allocation": "plan.json", "disjunctive-allocation": "obstacles.json", "exact-joint": "joint-plan.json",
    "non-dominated-paths": "roadmap.json", "supported-paths": "roadmap.json",
    "outer-approximation": "careful.json",
    "epsilon-scaling": "pairs.json", "lapjv": "pairs.json", "min-cost-flow": "pairs.json", "threshold-matching": "largest.json",
    "interval-scheduling": "day.json", "part-subsets": "shares.json", "task-subsets": "tasks.json",
}  # fmt: skip

APPROXIMATED = {
    "consensus-bundle": "many-tasks.json", "distributed-sampling": "many-shares.json", "fixed-order-auction": "many-tasks.json",
    "list-schedule": "day.json", "parallel-auction": "many-tasks.json", "sequential-single-item": "many-tasks.json",
    "bins-then-requests": "errands.json", "heard-greedy": "rooms.json", "local-ratio": "profits.json", "shmoys-tardos": "jobs.json",
    "bertsekas": "pairs.json", "auction": "pairs.json", "online-greedy": "pairs.json",
    "additive-risk": "map.json", "cvar": "likely-plan.json", "iterative": "plan.json", "least-mean": "roadmap.json",
    "look-back": "map.json",
    "rags": "roadmap.json", "scenario": "joint-plan.json", "two-stage": "rewards.json",
    "brute-force": "few.json", "christofides": "tour.json", "continuous-greedy": "partition.json", "greedy": "crowd.json",
    "greedy-assignment": "tour.json", "greedy-orienteering": "outing.json", "insertion": "large.vrp",
    "knapsack-greedy": "knapsack.json", "lazy-greedy": "cardinality.json", "local": "sensing.json", "lp-rounding": "crowd.json",
    "pure-greedy": "tour.json", "random": "crowd.json", "safety-margins": "risks.json", "savings": "large.vrp",
    "sequential-greedy": "partition.json", "split": "large.vrp", "stochastic-greedy": "cardinality.json",
    "tour-partitioning": "large.vrp", "tour-splitting": "even.json",
}  # fmt: skip

WITH_CHILDREN = ("pulp", "pulp:HiGHS", "ortools", "cvxpy", "cvxpy:HIGHS", "mathopt:highs", "vroom")

pytestmark = pytest.mark.timeout(3600)


@dataclass(frozen=True)
class Case:
    """A command, and what it writes."""

    words: tuple[str, ...]
    file: str
    writes: tuple[str, ...]


CASES = [
    *(Case(("solve", f, "--solver", s), f, ("out", "certificate")) for s, f in SOLVED.items() if BACKENDS[s.partition(":")[0]].installed()),
    *(Case(("solve", f, "--heuristic", h), f, ("out", "certificate")) for h, f in APPROXIMATED.items()),
    Case(("solve", "large.vrp"), "large.vrp", ("out", "certificate")),  # begun by one method, and gone on with by another
    *(Case(("bound", f), f, ("certificate",)) for f in ("routes.txt", "partition.json", "crowd.json", "sensing.json")),
    Case(("explain", "routes.txt", "--set", "vehicles=7"), "routes.txt", ()),
]


def test_every_solver_and_every_heuristic_is_interrupted() -> None:
    assert {name.partition(":")[0] for name in SOLVED} == set(BACKENDS)
    assert set(APPROXIMATED) == {info.name for info in wb.heuristics()}


@pytest.fixture(scope="module")
def instances(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """``instances(name)``: the file of this name, made on first use, and its problem."""
    folder, problems = tmp_path_factory.mktemp("instances"), {}

    def made(name: str) -> tuple[Path, Any]:
        path = folder / name
        if name not in problems:
            kind, *settings = FILES[name]
            words = [word for setting in settings for word in ("--set", setting)]
            subprocess.run([*COMMAND, "generate", kind, *words, "--out", str(path)], check=True, capture_output=True)
            if name in CHANGED:
                write_instance(CHANGED[name](read_instance(path)), path)
            problems[name] = wb.read(path)
        return path, problems[name]

    return made


def start_up() -> tuple[float, float]:
    """Seconds in which the command starts, and how many times its CPU time they are: 1 on a calm machine, 3 where three share a core."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([*COMMAND, "solve", "--help"], capture_output=True, check=True)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, max(1.0, wall / (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime))


def left_over(folder: Path) -> list[str]:
    """Processes whose temporary files would lie in ``folder``."""
    found = []
    for process in psutil.process_iter():
        try:
            if process.environ().get("TMPDIR", "").startswith(str(folder)) and process.status() != psutil.STATUS_ZOMBIE:
                found.append(" ".join(process.cmdline()))
        except (psutil.NoSuchProcess, psutil.AccessDenied):
            continue
    return found


def too_late(seconds: float) -> str:
    """What is wrong about an end after so long; where others keep the cores busy, everything takes so many times as long."""
    load = max(start_up()[1] for _ in range(3)) if seconds > PATIENCE else 1.0
    return f"ended after {seconds:.1f} s (load {load:.1f})" if seconds > PATIENCE * load else ""


def _heed() -> None:
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


class Run:
    """A command in folders of its own, and what a signal made of it."""

    def __init__(self, case: Case, path: Path, folder: Path) -> None:
        self.case, self.temporary, self.outputs = case, folder / "tmp", folder / "out"
        for made in (folder, self.temporary, self.outputs):
            made.mkdir()
        self.paths = {name: self.outputs / f"{name}.json" for name in case.writes}
        words = [str(path) if word == case.file else word for word in case.words]
        words += [word for name, file in self.paths.items() for word in (f"--{name}", str(file))]
        # Shells have their background jobs ignore signals of the keyboard, nohup that of the terminal; what is ignored stays so.
        self.process = subprocess.Popen(
            [*COMMAND, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "TMPDIR": str(self.temporary)}, preexec_fn=_heed,
        )  # fmt: skip

    def end(self, number: int) -> float:
        """Seconds from the signal to the end."""
        self.process.send_signal(number)
        began = time.perf_counter()
        try:
            self.out, self.err = self.process.communicate(timeout=30)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.out, self.err = self.process.communicate()
            return 30.0
        return time.perf_counter() - began

    def faults(self, number: int, problem: Any) -> list[str]:
        """What is wrong about the end, its time apart."""
        code, found = self.process.returncode, []
        written = {name: json.loads(path.read_text()) for name, path in self.paths.items() if path.exists()}
        if code not in (0, 128 + number):
            found.append(f"exit code {code}: {self.err[-300:]}")
        if "Traceback" in self.err or "error" in self.err.replace("error: interrupted", ""):
            found.append(f"says {self.err[-300:]}")
        if code != 0 and re.search(r"(objective|bound) [-\d]", self.err) and (self.case.words[0] == "bound" or "objective" in self.err):
            found.append(f"lost what it had: {self.err[-300:]}")
        if code == 0 and set(written) != set(self.paths):
            found.append(f"wrote only {sorted(written)}")
        if "out" in written:
            checked = wb.check(problem, self.paths["out"], self.paths["certificate"] if "certificate" in written else None)
            if not checked.feasible or code != 0:
                found.append(f"exit code {code} with an answer, feasible {checked.feasible}")
        elif "certificate" in written:
            check_certificate(problem, read_certificate(self.paths["certificate"]), None)
        return found + self.remains(0.2)

    def remains(self, seconds: float) -> list[str]:
        """Processes and files that are left after so long."""
        end, found = time.perf_counter() + seconds, ["?"]
        while found:
            found = [f"left running: {words}" for words in left_over(self.temporary)]
            # Children may be clearing up meanwhile: a walk passes over what vanishes under it.
            found += [f"left: {Path(folder, name)}" for folder, below, files in os.walk(self.temporary) for name in (*below, *files)]
            evidence = {path.with_suffix(".evidence.json.gz") for path in self.paths.values() if path.exists()}
            found += [f"left: {path}" for path in self.outputs.iterdir() if path not in {*self.paths.values(), *evidence}]
            if time.perf_counter() > end:
                break
            time.sleep(0.02)
        return found


def running_at(instant: float, case: Case, path: Path, folder: Path, rng: np.random.Generator, tally: Any) -> tuple[Run, float]:
    """A command that still runs after so many seconds: one that has ended by then is begun once more, for an earlier instant."""
    for attempt in itertools.count():
        run = Run(case, path, folder.with_name(f"{folder.name}-{attempt}"))
        time.sleep(instant)
        if run.process.poll() is None:
            break
        run.process.communicate()
        tally["commands that ended before their signal"] += 1
        instant *= float(rng.uniform(0.3, 0.9))
    return run, instant


@pytest.mark.share(2)
@pytest.mark.parametrize("part", range(PARTS))
def test_a_signal_at_any_instant_ends_a_command_in_two_seconds_with_its_best_answer(part, share, tally, instances, tmp_path) -> None:
    rng = np.random.default_rng(part)
    few, many = int(part < FEW), 200 // PARTS
    runs = share(few, many)
    order = np.concatenate([np.random.default_rng(7).permutation(len(CASES)) for _ in range(1 + 200 // len(CASES))])[part::PARTS]
    latest, faults, slowest = (0.8 if runs == few else 2.5), [], (0.0, "")
    wall, _ = start_up()
    for k, at in enumerate(itertools.islice(order, runs)):
        case, number = CASES[at], (signal.SIGINT, signal.SIGTERM)[int(rng.integers(2))]
        path, problem = instances(case.file)
        instant = wall + float(rng.uniform(0.0, latest))
        run, instant = running_at(instant, case, path, tmp_path / str(k), rng, tally)
        what = f"{' '.join(case.words)}, {number.name} after {instant:.2f} s"
        seconds = run.end(number)
        faults += [f"{what}: {fault}" for fault in [too_late(seconds), *run.faults(number, problem)] if fault]
        tally["signals at random instants"] += 1
        tally[f"ended with exit code {run.process.returncode}"] += 1
        slowest = max(slowest, (seconds, what))
        print(f"{seconds:.2f} s, exit code {run.process.returncode}: {what}")
    print(f"slowest: {slowest[0]:.2f} s, {slowest[1]}")
    assert not faults, "\n".join(faults)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(2))
def test_a_parent_that_is_killed_or_hung_up_on_takes_its_children_along(part, share, tally, instances, tmp_path) -> None:
    rng, faults = np.random.default_rng(part), []
    wall, _ = start_up()
    for k in range(share(part, 12)):
        solver = WITH_CHILDREN[(k * 2 + part) % len(WITH_CHILDREN)]
        number = (signal.SIGKILL, signal.SIGHUP, signal.SIGQUIT)[k % 3]
        case = Case(("solve", SOLVED[solver], "--solver", solver), SOLVED[solver], ("out", "certificate"))
        path, problem = instances(case.file)
        run, instant = running_at(wall + float(rng.uniform(0.5, 4.0)), case, path, tmp_path / str(k), rng, tally)
        seconds = run.end(number)
        what = f"{solver}, {number.name} after {instant:.2f} s"
        assert number is signal.SIGHUP or run.process.returncode == -number
        found = run.faults(number, problem) if number is signal.SIGHUP else run.remains(SETTLE)
        faults += [f"{what}: {fault}" for fault in [too_late(seconds), *found] if fault]
        tally["parents killed or hung up on"] += 1
    assert not faults, "\n".join(faults)
