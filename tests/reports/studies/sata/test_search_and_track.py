import pandas as pd
import pytest
from short_forms import short_form

from waybound.reports.studies.sata import search_and_track as study


@pytest.mark.slow
def test_the_short_study():
    report, html = short_form(study.search_and_track)
    assert [row["method"] for row in report.observations] == [*study.FLIGHTS, *study.LOOPS] * 2
    lost = {row["method"]: row["lost"] for row in report.observations if row["kind"] == "loop"}
    assert abs(lost["exact"]) < 1e-6 <= lost["sequential-greedy"] <= 50 + 1e-6 and lost["sequential-greedy"] < lost["random"]
    assert "three robots share out" in html


def test_claims_are_read_in_their_direction():
    def row(method, **own):
        return {"seed": 1, "method": method, **dict.fromkeys((*study.MEASURES, "variance_worst"), 1.0), **own}

    better = {"no repulsion": {"ospa": 3.0, "tracks": 0.5}}
    flights = pd.DataFrame([{**row(m, **better.get(m, {})), "seed": s} for s in (1, 2, 3) for m in study.FLIGHTS])
    loops = pd.DataFrame([{**row(m, ospa=1.0 + (m == "sequential-greedy")), "seed": s} for s in (1, 2, 3) for m in study.LOOPS])
    found = {f.what: f.verdict for f in study.findings(flights, loops)}
    assert found["OSPA without (2.11) against with it, above by"] == "sign reproduced"
    assert found["number of tracks without (2.11) against with it, below by"] == "sign reproduced"
    assert found["tracks, 20 % against 0 % clutter, above by"] == "undecided"
    assert found["greedy plans against exact ones, ospa, worse by"] == "sign reproduced"


def test_the_defaults_are_the_sources():
    settings = study.SearchAndTrack.settings
    known = {"robots": 1, "targets": 10, "width": 150, "sensing": 25, "robot-step": 0.5, "detection": 0.98, "survival": 1, "clutter": 0.1,
             "prune": 1e-3, "merge": 10, "gate": 10, "threshold": 0.5, "confirm": 3, "initial-offset": 15, "initial-variance": 50,
             "birth": 1, "turn-every": 400}  # fmt: skip
    assert {key: settings[key].default for key in known} == known
    assert study.SearchAndTrack.lasting == 7278
