import pytest

from waybound.reports.studies.sata.families import max_min as graphs, selection as random

RANDOM = [
    *(family for rule in random.CONSTRAINTS for family in random.random_families(rule)), random.RANDOM_ASSIGNMENTS,
    random.planted_covers("cardinality"), random.planted_covers("knapsack"), random.PLANTED_ASSIGNMENTS, *graphs.RANDOM_FAMILIES,
    graphs.RANDOM_PROGRAMS,
]  # fmt: skip


@pytest.mark.parametrize("family", RANDOM, ids=lambda family: family.name)
def test_a_case_depends_on_its_number_and_the_seed_alone(family):
    digests = {(k, seed): family.case(k, seed).problem.digest() for k in range(6) for seed in (1, 2)}
    assert len(set(digests.values())) > 6
    if family.name != "user-function":  # the digest of a program of the user's is that of its label
        assert all(family.case(k, seed).problem.digest() == digest for (k, seed), digest in digests.items())


@pytest.mark.share(2)
@pytest.mark.parametrize("family", RANDOM, ids=lambda family: family.name)
def test_every_case_can_be_solved(family):
    for k in range(30):
        case = family.case(k, 7)
        assert case.problem.evaluate(case.solved().answer).feasible
