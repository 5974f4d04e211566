"""A campaign on a disk that runs full, which this process must have to itself: ``python full_disks.py DISK`` of 1.5 MB.

Prints, a line each, what is told of it and how many runs are there then: at first, when it is tried again, and when there is room;
``damaged`` if the file is not sound.
"""

import sqlite3
import sys
from pathlib import Path

from campaign_cases import Here, campaign_file, outcome

from waybound import InputError, results
from waybound.reports.campaigns.campaign import Campaign, read_campaign
from waybound.reports.campaigns.running import run_campaign


def tried(asked: Campaign) -> str:
    """What is told of the campaign."""
    try:
        return f"{run_campaign(asked, Here(lambda task: outcome(float(task.seed), [['x' * 5000]])))} done"
    except InputError as fault:
        return str(fault)


def main(disk: Path) -> None:
    """Fill the disk, make room, and go on."""
    ballast = disk / "ballast"
    ballast.write_bytes(bytes(1_200_000))
    asked = read_campaign(campaign_file(disk, seeds=list(range(1, 21))))
    print(tried(asked))
    print(len(results(asked.results)))
    print(tried(asked))
    print(len(results(asked.results)))
    ballast.unlink()
    print(tried(asked))
    with sqlite3.connect(asked.results) as connection:
        sound = connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    print(len(results(asked.results)) if sound else "damaged")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
