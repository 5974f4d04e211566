"""Campaigns that are killed at random instants and taken up again, in forks of one process that has everything loaded.

``python killed_campaigns.py FOLDER TIMES SEED`` prints how many runs were there at each kill, and ``equal`` if the results are those of a
campaign that nobody disturbed.
"""

import os
import random
import signal
import sqlite3
import sys
import time
from pathlib import Path
from typing import Any

from campaign_cases import Here, campaign_file, outcome

from waybound.reports.campaigns.campaign import read_campaign
from waybound.reports.campaigns.one_run import Outcome, Task
from waybound.reports.campaigns.running import run_campaign

ROWS = """SELECT i.name, s.method, r.seed, r.status, r.objective, d.solution, d.history FROM runs r JOIN instances i ON i.id = r.instance
JOIN settings s ON s.id = r.setting JOIN documents d ON d.run = r.id ORDER BY i.name, s.method, r.seed"""


def _made_up(task: Task) -> Outcome:
    time.sleep(0.001)
    return outcome(float(task.seed), [["x" * 5000]])


def rows(results: Path) -> list[Any]:
    """All that is in a results file but times; it must be sound."""
    with sqlite3.connect(results) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        if not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
            return []  # it was killed before there was a table
        return connection.execute(ROWS).fetchall()


def main(folder: Path, times: int, seed: int) -> None:
    """Kill as often as asked for, finish, and compare."""
    draw = random.Random(seed)
    seeds = list(range(1, 61))
    undisturbed = read_campaign(campaign_file(folder, results="undisturbed.sqlite", seeds=seeds))
    began = time.monotonic()
    run_campaign(undisturbed, Here(_made_up))
    took = time.monotonic() - began
    killed = read_campaign(campaign_file(folder, results="killed.sqlite", seeds=seeds))
    for _ in range(times):
        pid = os.fork()
        if not pid:
            run_campaign(killed, Here(_made_up))
            os._exit(0)
        time.sleep(draw.uniform(0.0, 3.0 * took / times))
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
        print(len(rows(killed.results)) if killed.results.exists() else 0)
    run_campaign(killed, Here(_made_up))
    print("equal" if rows(killed.results) == rows(undisturbed.results) else "different")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
