import math

import pytest

from waybound.reports.studies.findings import NOT, REPRODUCED, SIGN, UNDECIDED, Finding, lead_text


@pytest.mark.parametrize(
    ("published", "ours", "verdict"),
    [
        ("0.714", 0.7143, REPRODUCED), ("0.714", 0.7146, NOT), ("41.85 %", 0.418525, REPRODUCED), ("47.16 %", 0.3604, NOT),
        ("2", 2.4, REPRODUCED),
    ],
)  # fmt: skip
def test_a_printed_number_is_reproduced_to_half_a_unit_of_its_last_digit(published, ours, verdict):
    found = Finding.of_number("n", published, ours, "because")
    assert (found.verdict, found.why) == (verdict, "because" if verdict == NOT else "")


@pytest.mark.parametrize(
    ("lead", "half", "verdict"),
    [(1.0, 0.5, SIGN), (-1.0, 0.5, NOT), (0.3, 0.5, UNDECIDED), (1.0, math.nan, UNDECIDED), (0.0, 0.0, UNDECIDED)],
)
def test_a_direction_needs_an_interval_on_its_side(lead, half, verdict):
    assert Finding.of_lead("n", "more", lead, half).verdict == verdict


@pytest.mark.parametrize(("apart", "half", "verdict"), [(0.01, 0.02, SIGN), (0.2, 0.1, NOT), (-0.2, 0.1, NOT), (0.04, 0.03, UNDECIDED)])
def test_alike_means_that_the_whole_interval_is_near(apart, half, verdict):
    assert Finding.of_near("n", "alike", apart, half, 0.05).verdict == verdict


def test_points_against_a_claim_are_named():
    points = [("a", 1.0, 0.1), ("b", -1.0, 0.1), ("c", 0.0, 0.1)]
    against = Finding.of_points("n", "more", points, "leads", "reason")
    assert (against.verdict, against.why, against.ours) == (NOT, "not at b: reason", "1 of 3 points; leads")
    many = Finding.of_points("gain", "above", [(f"a point of a long name, {k}", 0.0, 1.0) for k in range(9)], "leads")
    assert many.why == "open at 9 of 9 points"
    assert Finding.of_points("n", "more", [points[0], points[2]], "").verdict == UNDECIDED
    assert Finding.of_points("n", "more", points[:1], "").verdict == SIGN


@pytest.mark.parametrize(
    ("mean", "half", "text"),
    [(1285.3, 20.4, "1285 ± 20"), (0.3, 4.0, "0.30 ± 4.00"), (12.3456, 0.0123, "12.346 ± 0.012"), (5.0, math.nan, "5")],
)
def test_intervals_decide_how_many_digits_are_shown(mean, half, text):
    assert lead_text(mean, half) == text
