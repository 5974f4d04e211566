"""Write certificates of all families, which later versions have to accept: ``python tests/earlier_certificates/record.py``.

Each case is one JSON file: the instance, what was asked, the answer and the certificate, as the command line wrote them.
Cases that lie here are never written again: each was made by the version that it names.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
SCORES = "0 0 0\n{}3 4 5\n-6 8 7\n5 -12 9\n8 1 4\n-3 -3 2\n"
TSP = "TYPE : TSP\nDIMENSION : 6\nEDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 30 40\n3 -60 80\n4 50 -12\n5 8 1\n6 -3 -33\nEOF\n"
SITES = {"id": ["d", "a", "b", "c", "e", "f"], "x": [0, 3, -6, 5, 8, -3], "y": [0, 4, 8, -12, 1, -3]}
ROUTING = {"waybound": 1, "kind": "routing", "problem": "min-cost-vrp", "travel": {"metric": "euclidean"}}
RECHARGING = {
    **ROUTING, "name": "recharging", "sites": {**SITES, "depot": [True, False, False, False, False, True]},
    "fleet": [{"count": 2, "energy": {"capacity": 30, "stations": ["f"]}}],
}  # fmt: skip
SHIPMENTS = {
    **ROUTING, "name": "shipments", "fleet": [{"count": 2, "capacity": 4}],
    "sites": {**SITES, "shipments": [{"pickup": "a", "delivery": "c", "load": 3}, {"pickup": "f", "delivery": "b", "load": 2}]},
}  # fmt: skip
# What stands in for an instance (a text, a bundled name, or a recipe with its settings), and the arguments of `solve`.
CASES: dict[str, tuple[str | list[str], str]] = {
    "vrptw": (["demo-tiny"], "--solver highs"),
    "vrptw-25": (["demo-c25"], "--convention trunc1"),
    "cvrp-40": (["demo-x40"], "--bound-time 5"),
    "cvrp": (["random", "customers=9", "vehicles=3"], "--problem cvrp"),
    "tsp": (TSP, ""),
    "min-cost-vrp-savings": (["random", "customers=9", "vehicles=3", "capacity=30"], "--problem min-cost-vrp --heuristic savings"),
    "min-makespan-vrp": (["random", "customers=7", "vehicles=2"], "--problem min-makespan-vrp"),
    "cvrp-infeasible": (["random", "customers=5", "vehicles=1", "capacity=1"], "--problem cvrp"),
    "orienteering": ("30 1\n" + SCORES.format("0 0 0\n"), "--problem orienteering"),
    "team-orienteering": ("n 7\nm 2\ntmax 27\n" + SCORES.replace("{}", "") + "0 0 0\n", "--problem team-orienteering"),
    "recharging-vrp": (json.dumps(RECHARGING), ""),
    "pickup-and-delivery": (json.dumps(SHIPMENTS), ""),
    "bottleneck": (["sata-s3"], "--problem bottleneck"),
    "bottleneck-local": (["sensing-ring", "robots=12"], "--problem bottleneck --heuristic local"),
    "bottleneck-lp": (["sensing-regular", "robots=10"], "--problem bottleneck-lp"),
    "winner-takes-all": (["sata-s3"], "--problem winner-takes-all"),
    "winner-takes-all-greedy": (["sata", "robots=6", "targets=8", "phi=25"], "--problem winner-takes-all --heuristic greedy"),
    "selection": (["cover-30"], ""),
    "selection-lazy-greedy": (["cover-30"], "--heuristic lazy-greedy"),
    "risk-allocation": (["risk-allocation"], ""),
    "risk-allocation-auv": (["risk-allocation", "family=auv"], ""),
    "uncertain-path": (["figure-3-3"], ""),
    "uncertain-path-roadmap": (["prm-graph", "vertices=40"], ""),
    "risky-path": (["risky-grid", "rows=6", "columns=6"], ""),
    "bin-assignment": (["assignment", "robots=6"], "--problem bin-assignment"),
    "bottleneck-assignment": (["assignment", "robots=6"], "--problem bottleneck-assignment"),
    "bin-assignment-auction": (["assignment", "robots=6"], "--problem bin-assignment --heuristic auction"),
    "generalised-assignment": (["generalised-assignment"], ""),
    "joint-assignment": (["joint-assignment"], ""),
    "room-exploration": (["exploration-map"], ""),
    "orchard-day": (["orchard-day"], ""),
    "task-allocation": (["robot-tasks", "robots=2", "tasks=6"], "--problem task-allocation"),
    "balanced-partition": (["robot-tasks", "robots=2", "tasks=6"], "--problem balanced-partition"),
}


def waybound(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "waybound", *map(str, arguments)], capture_output=True, text=True, check=False)


def instance(source: str | list[str], folder: Path) -> Path:
    """The instance of a case as a file."""
    if isinstance(source, str):
        path = folder / "instance.txt"
        path.write_text(source, encoding="utf-8")
        return path
    name, *settings = source
    bundled = waybound("instances", "path", name)
    if bundled.returncode == 0:
        return Path(bundled.stdout.strip())
    path = folder / "instance.json"
    waybound(
        "generate", name, *(word for setting in settings for word in ("--set", setting)), "--seed", "3", "--out", path
    ).check_returncode()
    return path


def record(name: str) -> str:
    """Solve a case, write its file, and say what became of it."""
    source, arguments = CASES[name]
    with tempfile.TemporaryDirectory() as directory:
        folder = Path(directory)
        path, answer, certificate = instance(source, folder), folder / "answer.json", folder / "certificate.json"
        solved = waybound("solve", path, *arguments.split(), "--time-limit", "20", "--out", answer, "--certificate", certificate, "--json")
        if not certificate.exists():
            return f"{name}: {solved.stderr.strip()}\n"
        summary = json.loads(solved.stdout)
        version = waybound("--version").stdout.strip()
        case = {
            "version": version,
            "arguments": arguments,
            "file": path.name,
            "instance": path.read_text(encoding="utf-8"),
            "status": summary["status"],
        }
        case["answer"] = json.loads(answer.read_text(encoding="utf-8")) if answer.exists() else None
        case["certificate"] = json.loads(certificate.read_text(encoding="utf-8"))
    file = HERE / f"{name}.json"
    file.write_text(json.dumps(case, separators=(",", ":")) + "\n", encoding="utf-8")
    proved = f"{summary['bound_kind']} bound {summary['bound']}"
    return f"{name}: {summary['status']}, {summary['objective']}, {proved}, {file.stat().st_size} bytes\n"


if __name__ == "__main__":
    for case_name in CASES:
        if not (HERE / f"{case_name}.json").exists():
            sys.stdout.write(record(case_name))
            sys.stdout.flush()
