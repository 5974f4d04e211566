import pytest

from waybound.reports.plots.drawing import figure_without_display
from waybound.reports.studies.findings import NOT, SIGN
from waybound.reports.studies.sata import tracking_force_vectors as study


@pytest.fixture
def logs():
    """Greedy sees one target more than force vectors in single steps, and two fewer in long runs; five and ten targets."""
    rows = []
    for count in (5, 10):
        for seed in (1, 2, 3):
            for method, single, long in (("greedy", 1.0, -2.0), ("force-vector", 0.0, 0.0)):
                wobble = 0.01 * seed * (method == "greedy")
                for kind, lead in (("single", single), ("long", long)):
                    seen = count / 2 + lead + wobble
                    rows.append({"targets": count, "run": kind, "seed": seed, "method": method, "step": 1, "observed": seen, "kept": seen})
    return rows


def test_leads_are_of_the_same_targets(logs):
    known = {(row["targets"], row["method"]): row for row in study.force_vector_rows(logs)}
    assert known[5, "greedy"]["single_lead"] == pytest.approx(1.02) and known[5, "greedy"]["average_lead"] == pytest.approx(-1.98)
    assert known[10, "force-vector"]["single_lead"] == 0.0


def test_findings_say_what_the_runs_do(logs):
    found = {finding.what: finding for finding in study.force_vector_findings(study.force_vector_rows(logs))}
    assert found["greedy against force vectors, single steps, 5 targets"].verdict == SIGN
    assert found["greedy against force vectors, time averages, 10 targets"].verdict == NOT
    assert found["greedy over the number of targets"].verdict == SIGN


def test_bars_are_the_means_of_each_method_and_number_of_targets(logs):
    figure = figure_without_display(8.0, 4.0)
    study.force_vectors_figure(study.force_vector_rows(logs)).draw(figure)
    singles, averages = figure.axes
    assert [round(float(bar.get_height()), 2) for bar in singles.patches] == [3.52, 6.02, 2.5, 5.0]
    assert [round(float(bar.get_height()), 2) for bar in averages.patches] == [0.52, 3.02, 2.5, 5.0]


def test_the_sizes_are_the_sources():
    assert study.TARGETS == (10, 20, 30) and study.tracking_force_vectors.instances == 10
    assert set(study.COLOURS) == set(study.PARKER)
