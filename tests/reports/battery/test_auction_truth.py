"""Truth of robots, bins and rooms by enumeration, on examples worked by hand."""

from fractions import Fraction

import pytest
from explorations import path
from joint_assignments import WORKED
from knapsack_assignments import worked
from orchard_cases import ONE_ROUTE, lane, retrievals

import waybound as wb
from waybound.reports.battery.auction_truth import fractions
from waybound.reports.battery.truth import Truth, truth


def test_infinities_stay_what_they_are() -> None:
    assert fractions([[0.5, float("inf")], []]) == [[Fraction(1, 2), float("inf")], []]


def test_jobs_within_capacities() -> None:
    assert truth(worked()) == Truth("optimal", Fraction(6))
    assert truth(worked("profit")) == Truth("optimal", Fraction(12))
    assert truth(wb.GeneralisedAssignment.from_arrays([[1.0]], [[2.0]], 1.0)) == Truth("infeasible")


def test_errands_by_requests() -> None:
    assert truth(WORKED) == Truth("optimal", Fraction(6))


def test_bins_beside_the_repository_and_in_the_next_lane() -> None:
    # A step to the first, one back; the other is two cells away over the headland, one step and two back.
    assert truth(retrievals([(0, 1)], [0], [(0, 0)])) == Truth("optimal", Fraction(2))
    assert truth(retrievals([(1, 1)], [0])) == Truth("optimal", Fraction(3))
    assert truth(retrievals([(0, 1), (0, 1)], [0, 0], objective="completion")) == Truth("optimal", Fraction(4))
    with pytest.raises(NotImplementedError, match="to be brought"):
        truth(wb.OrchardDay(wb.OrchardJobs.of_routes(lane(ONE_ROUTE, 1), ONE_ROUTE)))


def test_a_room_out_of_contact_is_worth_it_where_there_is_time_for_the_way_back() -> None:
    assert truth(path(2, 1, 2)) == Truth("optimal", Fraction(1))
    assert truth(path(2, 0, 2)) == Truth("optimal", Fraction(0))
    assert truth(path(3, 1, 3, target=2)) == Truth("optimal", Fraction(0))
