from waybound.reports.benchmarks.routing_variants import CHANGES, CUSTOMERS, TURNS, drawn, features_of
from waybound.reports.tables.routing.routing_features import ROWS


def test_each_has_the_feature_whose_turn_it_is() -> None:
    for number, feature in enumerate(TURNS):
        problem = drawn(3, number)
        assert feature in features_of(problem) and problem.name == f"{feature}-{number}"
        assert 1 <= len(problem.customers) <= max(CUSTOMERS)


def test_they_are_drawn_by_number_alone() -> None:
    assert drawn(3, 17).digest() == drawn(3, 17).digest() != drawn(4, 17).digest()


def test_there_is_a_variant_of_all_that_a_problem_may_ask() -> None:
    assert set(CHANGES) >= set(ROWS)
