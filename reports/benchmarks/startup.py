"""Start of ``import waybound`` and ``waybound --help`` against a bare interpreter that imports numpy: at most 3 times as long.

Exit code 1 if a ratio is above 3, or if a solver is imported.
"""

import json
import statistics
import subprocess
import sys
import time

from ._harness import command

LIMIT = 3.0
REPEATS = 15

CASES = {
    "interpreter and numpy": ["-c", "import numpy"],
    "import waybound": ["-c", "import waybound"],
    "waybound --help": ["-m", "waybound", "--help"],
    "waybound solve --help": ["-m", "waybound", "solve", "--help"],
}

HEAVY = ("highspy", "ortools", "pulp", "cvxpy", "pyvrp", "pandas", "scipy", "matplotlib", "numba", "networkx")

_LIST_MODULES = """
import sys
sys.argv = ["waybound", "--help"]
try:
    {action}
except SystemExit:
    pass
import json
print(json.dumps(sorted({{name.partition(".")[0] for name in sys.modules}})), file=sys.stderr)
"""


_ACTIONS = {"import waybound": "import waybound", "waybound --help": "import waybound.cli; waybound.cli.main()"}


def seconds(arguments: list[str]) -> float:
    """Wall time of one fresh interpreter."""
    began = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def heavy_modules(action: str) -> list[str]:
    """Heavy packages that a fresh interpreter has loaded after ``action``."""
    run = subprocess.run([sys.executable, "-c", _LIST_MODULES.format(action=action)], check=True, capture_output=True, text=True)
    loaded = json.loads(run.stderr.strip().splitlines()[-1])
    return sorted(set(loaded) & set(HEAVY))


def measure(repeats: int = REPEATS) -> dict[str, float]:
    """Median seconds of each case; the cases take turns, so that all of them see the same load of the machine."""
    taken: dict[str, list[float]] = {name: [] for name in CASES}
    for _ in range(repeats):
        for name, arguments in CASES.items():
            taken[name].append(seconds(arguments))
    return {name: statistics.median(values) for name, values in taken.items()}


@command
def main() -> bool:
    measured = measure()
    base = measured.pop("interpreter and numpy")
    print(f"{'interpreter and numpy':<24} {base * 1000:7.0f} ms   (median of {REPEATS})")
    worst = 0.0
    for name, value in measured.items():
        worst = max(worst, value / base)
        print(f"{name:<24} {value * 1000:7.0f} ms   ratio {value / base:.2f}, limit {LIMIT:g}")
    loaded = {what: heavy_modules(action) for what, action in _ACTIONS.items()}
    for what, names in loaded.items():
        print(f"{what:<24} loads {', '.join(names) or 'no solver, no pandas, no scipy'}")
    return worst <= LIMIT and not any(loaded.values())
