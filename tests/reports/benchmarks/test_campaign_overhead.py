"""The benchmark of campaigns measures what it says; its times are not tested."""

from pathlib import Path

import pytest

from waybound.reports.benchmarks import campaign_overhead
from waybound.reports.campaigns.frames import results


def test_rows_are_made_up_of_ten_methods_and_a_hundred_seeds(tmp_path: Path) -> None:
    campaign_overhead.made_up(tmp_path / "r.sqlite", 1000)
    frame = results(tmp_path / "r.sqlite", ["instance", "method", "seed", "seconds"])
    assert len(frame) == 1000 and frame.nunique().to_dict() == {"instance": 1, "method": 10, "seed": 100, "seconds": 97}


@pytest.mark.slow
def test_a_run_costs_its_search_and_something_more() -> None:
    made = campaign_overhead.cost('heuristics = ["savings"]', "demo-tiny", 3, 1)
    assert 0.0 < made.search < made.wall and made.processor > 0.0
