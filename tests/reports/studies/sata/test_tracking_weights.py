import pytest

from waybound.reports.plots.drawing import figure_without_display
from waybound.reports.studies.findings import NOT, SIGN
from waybound.reports.studies.sata import tracking_weights as study


def logs(errors):
    """Two runs of two steps for each kind of weights, whose values are off by a share; in one step nothing came true."""
    return [
        {"method": method, "seed": seed, "step": step, "observed": 5.0, "estimated_targets": 4.0, "actual_targets": 4.0,
         "estimated_value": 2.0 * (1.0 + error + 0.001 * seed), "actual_value": 2.0 if step == 1 else 0.0}
        for method, error in errors.items() for seed in (1, 2) for step in (1, 2)
    ]  # fmt: skip


def test_relative_errors_leave_out_steps_without_an_actual_value():
    rows = study.weight_rows(logs(dict.fromkeys(study.WEIGHTS, 0.5)))
    assert rows[0]["value_error"] == pytest.approx(0.5015) and rows[0]["targets_error"] == 0.0


@pytest.mark.parametrize(("far", "verdict"), [(0.3, SIGN), (0.01, NOT)])
def test_findings_compare_the_two_kinds_run_by_run(far, verdict):
    made = logs({"binary": 0.1, "inverse-distance": far, "binary, noisy": 0.1, "inverse-distance, noisy": far})
    found = {finding.what: finding for finding in study.weight_findings(study.weight_rows(made), made)}
    assert found["error of inverse distances above binary"].verdict == verdict


def test_estimates_stand_over_what_came_true():
    figure = figure_without_display(8.0, 4.0)
    study.weights_figure(logs({"binary": 0.0, "inverse-distance": 0.5})).draw(figure)
    counts, values = figure.axes
    assert counts.lines[0].get_xydata().tolist() == [[4.0, 4.0]] * 4
    assert values.lines[1].get_xydata()[0].tolist() == pytest.approx([2.0 / 3.004, 3.002 / 3.004])
