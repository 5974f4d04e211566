import numpy as np
import pytest

from waybound.heuristics.routing._relay_roles import DONE, EXPLORE, MEET, RETURN, SEARCH, WAIT, RelayRoles, next_step
from waybound.instances.routing.worlds.unreliable_communication import CommunicationObservation

WIDE = 22
"""A corridor of twenty cells from 23 on, in its walls."""

BASE = WIDE + 1


def seen(places, battery, groups, seen_to=20):
    """An observation in a corridor, robots ``places`` cells from the base."""
    maps = np.zeros((len(places), 3 * WIDE), dtype=bool)
    maps[:, BASE : BASE + seen_to] = True
    return CommunicationObservation(0, BASE, WIDE, tuple(BASE + p for p in places), tuple(battery), maps, maps, groups)


def steps(places):
    return [np.abs(np.arange(3 * WIDE) - BASE - place) for place in places]


def advance(roles, places, battery, groups, frontier=True):
    roles.advance(seen(places, battery, groups), steps(places), [frontier] * len(places))
    return [own.mode for own in roles.members]


def test_the_lower_number_becomes_the_relay_and_new_roles_replace_old_ones():
    roles = RelayRoles(8, BASE)
    roles.meet([5, 2], BASE)
    assert (roles.members[2].feeder, roles.members[2].relay) == (5, None)
    assert (roles.members[5].feeder, roles.members[5].relay) == (None, 2)
    roles.meet([5, 7], BASE + 3)
    assert (roles.members[5].feeder, roles.members[5].relay) == (7, None)
    assert (roles.members[7].feeder, roles.members[7].relay, roles.members[7].relay_at) == (None, 5, BASE + 3)
    assert roles.members[2].feeder == 5  # it does not know


def test_in_a_chain_a_relay_keeps_its_own_relay():
    roles = RelayRoles(8, BASE, kind="chain")
    roles.meet([2, 5], BASE)
    roles.meet([5, 7], BASE + 3)
    assert (roles.members[5].feeder, roles.members[5].relay) == (7, 2)
    roles.meet([0, 1, 3], BASE)
    assert [roles.members[k].relay for k in (0, 1, 3)] == [None, 0, 1]


def test_of_several_that_meet_pairs_are_made_and_one_may_stay_without_a_role():
    roles = RelayRoles(5, BASE)
    roles.meet(range(5), BASE)
    assert [own.relay for own in roles.members] == [None, 0, None, 2, None]
    assert [own.feeder for own in roles.members] == [1, None, 3, None, None]
    alone = RelayRoles(5, BASE, rule="home")
    alone.meet(range(5), BASE)
    assert all(own.relay is None and own.feeder is None for own in alone.members)


@pytest.mark.parametrize(("battery", "mode"), [(12, EXPLORE), (10, WAIT), (9, WAIT)])
def test_a_relay_lands_where_its_battery_just_lets_it_go_home(battery, mode):
    roles = RelayRoles(2, BASE, margin=0)
    roles.meet([0, 1], BASE)
    assert advance(roles, [10, 15], [battery, 20], ((0,), (1,)))[0] == mode


@pytest.mark.parametrize(("battery", "mode"), [(6, EXPLORE), (5, RETURN)])
def test_a_sacrifice_turns_back_where_its_battery_just_lets_it_come_to_its_relay(battery, mode):
    roles = RelayRoles(2, BASE, margin=0)
    roles.meet([0, 1], BASE + 10)
    assert advance(roles, [10, 15], [20, battery], ((0,), (1,)))[1] == mode
    assert roles.goal_of_return(1) == BASE + 10


def test_by_the_printed_rule_it_turns_back_where_it_just_could_come_home():
    roles = RelayRoles(2, BASE, rule="printed", margin=0)
    roles.meet([0, 1], BASE + 10)
    assert advance(roles, [10, 15], [20, 16], ((0,), (1,)))[1] == EXPLORE
    assert advance(roles, [10, 15], [20, 15], ((0,), (1,)))[1] == RETURN


def test_a_radio_spares_the_last_steps():
    roles = RelayRoles(2, BASE, margin=0, credit=3)
    roles.meet([0, 1], BASE + 10)
    assert roles.spare(1, 5, steps([15])[0]) == 3
    assert roles.spare(1, 5, steps([11])[0]) == 5  # within reach it needs nothing


def test_after_the_period_a_robot_goes_to_its_last_meeting_and_explores_again_if_nobody_is_there():
    roles = RelayRoles(2, BASE, period=60)
    roles.meet([0, 1], BASE + 4)
    roles.members[0].since = 60
    assert advance(roles, [8, 15], [100, 100], ((0,), (1,))) == [MEET, EXPLORE]
    assert advance(roles, [5, 15], [97, 97], ((0,), (1,))) == [MEET, EXPLORE]  # on its way
    assert advance(roles, [4, 15], [96, 96], ((0,), (1,))) == [EXPLORE, EXPLORE]
    assert roles.members[0].since == 0


def test_a_meeting_on_the_way_counts_and_gives_new_roles():
    roles = RelayRoles(3, BASE, period=60)
    roles.members[2].since = 60
    assert advance(roles, [2, 9, 8], [100] * 3, ((0,), (1,), (2,))) == [EXPLORE, EXPLORE, MEET]
    assert advance(roles, [2, 9, 8], [100] * 3, ((0,), (1, 2))) == [EXPLORE, EXPLORE, EXPLORE]
    assert (roles.members[2].relay, roles.members[2].met, roles.members[2].since) == (1, BASE + 9, 1)


def test_the_map_is_handed_over_and_the_relay_flies_home():
    roles = RelayRoles(2, BASE, margin=0)
    roles.meet([0, 1], BASE)
    assert advance(roles, [10, 15], [10, 30], ((0,), (1,))) == [WAIT, EXPLORE]
    roles.members[1].relay_at = BASE + 10
    assert advance(roles, [10, 15], [10, 5], ((0,), (1,))) == [WAIT, RETURN]
    assert advance(roles, [10, 10], [10, 0], ((0, 1),)) == [RETURN, DONE]
    assert roles.goal_of_return(0) == BASE
    assert advance(roles, [0, 10], [0, 0], ((0,), (1,))) == [DONE, DONE]


def test_a_sacrifice_that_finds_nobody_explores_until_it_is_empty():
    roles = RelayRoles(2, BASE, margin=0)
    roles.meet([0, 1], BASE + 10)
    assert advance(roles, [3, 13], [50, 3], ((0,), (1,)))[1] == RETURN
    assert advance(roles, [3, 10], [50, 2], ((0,), (1,)))[1] == SEARCH
    assert advance(roles, [3, 11], [50, 0], ((0,), (1,)))[1] == DONE


def test_with_nothing_left_to_explore_it_tries_to_come_home_itself():
    roles = RelayRoles(2, BASE)
    roles.meet([0, 1], BASE + 10)
    assert advance(roles, [3, 10], [50, 50], ((0,), (1,)), frontier=False)[1] == RETURN
    assert roles.goal_of_return(1) == BASE


def test_patience_ends():
    roles = RelayRoles(2, BASE, margin=0, patience=2)
    roles.meet([0, 1], BASE)
    modes = [advance(roles, [10, 15], [10, 30], ((0,), (1,)))[0] for _ in range(3)]
    assert modes == [WAIT, WAIT, RETURN]


def test_a_robot_without_a_role_flies_home():
    roles = RelayRoles(1, BASE, margin=0)
    assert advance(roles, [10], [10], ((0,),)) == [RETURN]
    assert advance(roles, [0], [0], ((0,),)) == [DONE]


def test_the_next_step_leads_nearer():
    assert next_step(steps([0])[0], BASE + 5, WIDE) == BASE + 4
