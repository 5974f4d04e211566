"""Costs of a campaign beside its runs: time a trivial run, throughput of two workers against one, and reading a million rows.

Exit code 1 if a trivial run costs 150 ms or more beside its search, or two workers give less than 1.8 times the throughput of one.
"""

import itertools
import resource
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from ..campaigns.campaign import Planned, read_campaign
from ..campaigns.counting import COUNTED, counted
from ..campaigns.frames import results
from ..campaigns.instance_list import Named
from ..campaigns.one_run import Outcome
from ..campaigns.profiles import profile
from ..campaigns.results_file import ResultsFile
from ..campaigns.run_processes import RunProcesses
from ..campaigns.running import run_campaign
from ..campaigns.setting import Setting
from ._harness import command, timed

MOST_OVERHEAD = 0.15
LEAST_THROUGHPUT = 1.8
WARM = 5
"""First runs, which load what the others find there."""

CAMPAIGN = """results = "r.sqlite"
instances = ["{instance}"]
{methods}
seeds = {seeds}
time_limit = 1
bound_time = 0
"""


@dataclass(frozen=True)
class Cost:
    """Seconds a run: wall time from one end to the next, of its search, and processor time of all processes."""

    wall: float
    search: float
    processor: float


def cost(methods: str, instance: str, runs: int, jobs: int) -> Cost:
    """Costs of each run of a campaign of ``runs`` seeds, after the first ones."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "c.toml"
        file.write_text(CAMPAIGN.format(instance=instance, methods=methods, seeds=list(range(1, runs + WARM + 1))))
        campaign, ends = read_campaign(file), list[float]()
        run_campaign(campaign, RunProcesses(jobs), progress=lambda *_: ends.append(time.perf_counter()))
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        search = float(results(campaign.results, ["seconds"])["seconds"].mean())
        return Cost((ends[-1] - ends[WARM - 1]) / runs, search, (used.ru_utime + used.ru_stime) / (runs + WARM))


def made_up(path: Path, rows: int) -> None:
    """A results file of ten methods, a hundred seeds and as many instances as ``rows`` asks for, of runs that nobody did."""
    row = {
        "problem": "vrptw", "sense": "min", "convention": "exact", "status": "optimal", "limit": "none", "objective": 1.0,
        "verified_bound": 1.0, "checked": 1, "faults": 0, "seconds": 1.0,
    }  # fmt: skip
    methods = [Setting(method=f"m{k}") for k in range(10)]
    with ResultsFile(path) as file:
        for number in range(max(1, rows // 1000)):
            named = Named(f"i{number}", "", path, f"hash-{number}")
            of_instance = itertools.product(enumerate(methods), range(100))
            file.add_all(
                (Planned(named, method, seed), Outcome({**row, "seconds": 1.0 + (number * 7 + k * 13 + seed * 31) % 97}, {}, {}, {}))
                for (k, method), seed in of_instance
            )


def profiled(rows: int) -> float:
    """Processor seconds from a results file of so many rows to a performance profile."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.sqlite"
        made_up(path, rows)
        return timed(lambda: profile(counted(results(path, COUNTED)), "seconds"))[0]


@command
def main(runs: int = 1000, seconds: int = 30, rows: int = 1_000_000) -> bool:
    trivial = cost('heuristics = ["savings"]', "demo-tiny", runs, 1)
    overhead = trivial.wall - trivial.search
    processor = f"{1000 * trivial.processor:.0f} ms of processors, start included"
    print(f"a trivial run   {1000 * overhead:6.0f} ms beside its search, limit {1000 * MOST_OVERHEAD:g}; {processor}")
    one, two = (cost('solvers = ["pyvrp"]', "demo-c25", seconds, jobs) for jobs in (1, 2))
    print(f"runs of 1 s     {one.wall:6.2f} s each by one worker, {two.wall:.2f} s by two: {one.wall / two.wall:.2f} times the throughput")
    print(f"{rows:,} rows  {profiled(rows):6.1f} s of processors from the file to a performance profile")
    return overhead < MOST_OVERHEAD and one.wall / two.wall >= LEAST_THROUGHPUT
