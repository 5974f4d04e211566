import pytest

from waybound.instances.routing.worlds.plume_exploration import serpentine
from waybound.reports.studies.routing import plume_bounds as study


def test_formulas():
    assert study.claimed_times(1, 2.5, 1.0)[0] == (pytest.approx(2 * 3.5 / 1.5), pytest.approx(2 / 1.5))
    (fourth, summand), (fifth, further) = study.claimed_times(20, 2.5, 1.0)
    assert (fourth, fifth) == (pytest.approx(22.4, abs=1e-9), pytest.approx(2 * 3.5 * 364 / 7.5, abs=1e-9))
    assert (summand, further) == (pytest.approx(2 / 7.5), pytest.approx(48 / 7.5))
    assert study.shortest_time(10, 1, 2.5, 1.0) == pytest.approx(2.571429, abs=1e-6)
    assert [study.longest_time(13, 3, robots, 1.0, 0.0) for robots in (1, 2, 3, 4, 8)] == [24, 15, 15, 12, 10.5]


@pytest.mark.parametrize(
    ("width", "robots", "cells", "time", "tours", "claimed"),
    [
        (9, 4, 89, 176, 42.32, 169.96),
        (15, 2, 239, 476, 151.77, 456.31),
        (21, 4, 461, 920, 167.95, 672.46),
        (41, 8, 1721, 3440, 321.62, 1769.40),
    ],
)
def test_theorem_4_fails_on_serpentines(width, robots, cells, time, tours, claimed):
    row = study.counterexample(width, robots)
    assert (row["cells"], row["depth_first"]) == (cells, time)
    assert row["straight_tours"] <= tours + 0.005
    assert row["claimed_at_most"] <= claimed + 0.01 < row["depth_first"]
    assert row["ratio"] <= row["proved_ratio"]


def test_straight_tours_cover_the_path():
    path = serpentine(7)
    for robots in (1, 2, 3, 9):
        pieces = study.straight_tours(path, robots)
        assert len(pieces) <= robots
        assert [k for first, last in pieces for k in range(first, last + 1)] == list(range(len(path)))
    assert study.tour_time(path, (0, len(path) - 1)) == pytest.approx(len(path) - 1 + 180**0.5)  # it ends at (6, 12)


def test_a_fat_stadium_may_hold_no_cell():
    """Lemmas 5 and 6: it meets 42 cells and holds none; with the grid half a cell lower it holds 17."""
    assert study.stadium_cells(20.0, 0.5, 0.5) == (0, 42)
    assert study.stadium_cells(20.0, 0.5, 0.0)[0] == 17


def test_the_lawn_mower_is_no_lower_bound():
    stairs = study.staircase(6)
    assert study.depth_first(stairs, stairs[0], 1).played.clock == 2 * (len(stairs) - 1) < study.lawn_mower((0, 0, 6, 6), 1, 1.0, (0, 0))[1]


def test_the_report_tells_what_fails():
    report = study.plume_bounds(full=False)
    assert report.num_faults == 0 and len(report.rows) == len(study.SERPENTINES)
    assert {finding.verdict for finding in report.findings} == {study.NOT}
