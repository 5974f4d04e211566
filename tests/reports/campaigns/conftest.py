"""One small campaign, done by real processes, that all tests of this folder look at."""

from dataclasses import dataclass
from pathlib import Path

import pytest
from campaign_cases import campaign_file

from waybound.reports.campaigns.campaign import Campaign, read_campaign
from waybound.reports.campaigns.run_processes import RunProcesses
from waybound.reports.campaigns.running import run_campaign


@dataclass(frozen=True)
class Done:
    """A campaign that was done, what it told meanwhile, and how many runs it did."""

    campaign: Campaign
    told: list[tuple[int, int, str]]
    count: int

    @property
    def results(self) -> Path:
        return self.campaign.results


@pytest.fixture(scope="session")
def done(tmp_path_factory: pytest.TempPathFactory) -> Done:
    """Two heuristics with a grid, of which one cannot take the problem, on a bundled instance; two seeds."""
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "bks.csv").write_text("instance,convention,objective,value\ndemo-tiny,euclidean-double,distance,400\n")
    asked = campaign_file(
        folder, heuristics=["savings", "local"], grid={"local": {"h": [1, 2]}}, best_known="bks.csv", convention="exact", seeds=[1, 2]
    )
    told: list[tuple[int, int, str]] = []
    campaign = read_campaign(asked)
    count = run_campaign(campaign, RunProcesses(2), progress=lambda *event: told.append(event))
    return Done(campaign, told, count)
