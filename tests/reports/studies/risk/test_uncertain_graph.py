import numpy as np
import pandas as pd
import pytest

from waybound.reports.studies.findings import NOT, SIGN
from waybound.reports.studies.risk import uncertain_graph as study


@pytest.fixture
def walks():
    """Six graphs of three draws: rags a point below A*, five below greedy, a point above D* Lite."""
    rng = np.random.default_rng(1)
    offsets = {"rags": 0.0, "rags-unobserved": 1.0, "a-star": 1.0, "greedy": 5.0, "d-star-lite": -1.0}
    return pd.DataFrame(
        {"level": 20.0, "graph": graph, "seed": draw, "method": method, "excess": 3.0 + offset + 0.1 * rng.normal()}
        for graph in range(6) for draw in range(3) for method, offset in offsets.items()
    )  # fmt: skip


def test_policies_are_compared_on_the_same_graphs(walks):
    rows = {row["method"]: row for row in study.excess(walks)}
    assert rows["a-star"]["rags_above"] == pytest.approx(-1.0, abs=0.2) and rows["a-star"]["rags_above_half"] < 0.3
    assert rows["rags"]["rags_above"] == 0.0 and rows["greedy"]["mean"] == pytest.approx(8.0, abs=0.2)


def test_findings_say_what_the_walks_do(walks):
    found = {finding.what: finding for finding in study.findings(walks, study.excess(walks))}
    assert found["mean of rags against A*, variances to 20"].verdict == SIGN
    assert found["mean of rags against D* Lite, variances to 20"].verdict == NOT
    assert found["95 % quantile of each graph, variances to 20"].verdict == SIGN


def test_all_policies_meet_the_same_costs():
    seen = pd.DataFrame(study.uncertain_roadmaps(full=False).observations)
    assert seen.groupby(["graph", "seed"])["hindsight"].nunique().tolist() == [1] * 6
    assert seen["excess"].min() >= -1e-9 and seen["arrived"].all()


def test_the_sizes_are_the_sources():
    assert (study.VARIANCES, study.uncertain_roadmaps.instances) == ((5.0, 10.0, 20.0), 20)


@pytest.mark.long
def test_what_can_be_asserted_of_the_policies():
    """A hundred graphs of ten paired draws: rags with observed edges below A*, far below greedy; nothing about D* Lite."""
    done = study.walked(study.uncertain_roadmaps.setting(instances=100), "variance", (20.0,), 10)
    table = {row["method"]: row for row in study.excess(pd.DataFrame(done.rows))}
    assert table["a-star"]["rags_above"] < 0.0
    assert table["greedy"]["rags_above"] < -5.0
