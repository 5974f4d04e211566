import numpy as np
import pytest
from coded import coded

from waybound import RiskyPath, UsageError
from waybound.instances.generating import generate


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("seed", range(5))
def test_blocks_leave_a_way_to_the_goal(connectivity, seed):
    graph = generate("risky-grid", seed, rows=9, columns=7, occupied=0.5, connectivity=connectivity)
    assert np.isfinite(RiskyPath(graph).moves.to_states()).all()
    assert (graph.state_name(graph.start), graph.state_name(graph.goals[0])) == ("0,0", "8,6")


def test_the_same_seed_gives_the_same_map():
    first, second, other = (generate("risky-grid", seed, mud=0.2, tether=True).digest() for seed in (3, 3, 4))
    assert first == second != other


def test_rewards_free_the_end():
    graph = generate("risky-grid", 1, rewards=5, discount=0.5, tether=True, mud=0.1)
    assert (np.count_nonzero(graph.rewards), graph.goals, graph.objective, graph.discount) == (5, (), "reward-per-risk", 0.5)
    assert [e.label for e in graph.elements] == ["clearance", "length", "turn", "mud", "tether"]


@pytest.mark.parametrize(("given", "code"), [({"connectivity": 6}, "out-of-range"), ({"rows": 900, "columns": 900}, "too-large")])
def test_what_cannot_be_made_is_refused(given, code):
    with pytest.raises(UsageError, check=coded(code)):
        generate("risky-grid", 1, **given)
