"""Bundled campaigns are ones that can be run."""

from __future__ import annotations

from pathlib import Path

from waybound.reports.campaigns.bundled import bundled_campaigns
from waybound.reports.campaigns.campaign import read_campaign


def test_every_bundled_campaign_can_be_read_and_puts_its_results_where_the_user_is(tmp_path: Path) -> None:
    assert "demo-campaign" in bundled_campaigns()
    for name, file in bundled_campaigns().items():
        campaign = read_campaign(file, tmp_path)
        assert campaign.results == tmp_path / f"{name}.sqlite" and 10 < len(campaign.runs) < 100
