import itertools

import pytest

from waybound.formulations.programs.exactness import Exactness

EXACT, RELAXATION, RESTRICTION, NEITHER = Exactness.EXACT, Exactness.RELAXATION, Exactness.RESTRICTION, Exactness.NEITHER


@pytest.mark.parametrize("flag", Exactness)
def test_an_exact_step_changes_nothing(flag):
    assert EXACT.then(flag) is flag
    assert flag.then(EXACT) is flag
    assert flag.then(flag) is flag


def test_opposite_steps_leave_nothing_to_be_said():
    assert RELAXATION.then(RESTRICTION) is NEITHER
    assert RESTRICTION.then(RELAXATION) is NEITHER
    assert NEITHER.then(RELAXATION) is NEITHER


def test_the_order_of_grouping_does_not_matter():
    for a, b, c in itertools.product(Exactness, repeat=3):
        assert a.then(b).then(c) is a.then(b.then(c))


def test_a_chain_promises_no_more_than_each_of_its_steps():
    for a, b in itertools.product(Exactness, repeat=2):
        chain = a.then(b)
        assert chain.bound_is_valid == (a.bound_is_valid and b.bound_is_valid)
        assert chain.answer_is_valid == (a.answer_is_valid and b.answer_is_valid)
        assert chain.infeasibility_is_valid == chain.bound_is_valid


def test_only_relaxations_bound_and_only_restrictions_answer():
    assert [f.bound_is_valid for f in (EXACT, RELAXATION, RESTRICTION, NEITHER)] == [True, True, False, False]
    assert [f.answer_is_valid for f in (EXACT, RELAXATION, RESTRICTION, NEITHER)] == [True, False, True, False]
