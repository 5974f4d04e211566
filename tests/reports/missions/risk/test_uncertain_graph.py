import numpy as np
import pytest
from file_cases import check_refused
from uncertain_graphs import WORKED, graph_of

import waybound as wb
from waybound.instances.errors import UsageError
from waybound.instances.writing import write_instance
from waybound.reports.missions.risk.uncertain_graph import POLICIES, UncertainGraphMission

SMALL = {"vertices": 25, "graph": 2, "steps": 14}


@pytest.mark.parametrize("policy", POLICIES)
def test_every_policy_arrives_and_none_beats_hindsight(policy):
    log = wb.run("uncertain-graph", policy=policy, seed=4, **SMALL)
    last = log.iloc[-1]
    assert last["arrived"] == 1.0
    assert last["excess"] >= -1e-9
    assert (policy != "hindsight") or last["excess"] == pytest.approx(0.0, abs=1e-9)
    assert log["cost"].is_monotonic_increasing


def test_planning_on_means_is_d_star_lite():
    costs = [
        wb.run("uncertain-graph", seed=seed, bound_time=0.0, **how, **SMALL)["cost"].tolist()
        for seed in (1, 2)
        for how in ({"policy": "d-star-lite"}, {"solver": "supported-paths"})
    ]
    assert costs[0] == pytest.approx(costs[1])
    assert costs[2] == pytest.approx(costs[3])


def test_a_solver_is_asked_until_the_goal(tmp_path):
    write_instance(graph_of(WORKED), tmp_path / "g.csv")
    log = wb.run("uncertain-graph", heuristic="rags", steps=6, seed=2, file=str(tmp_path / "g.csv"), risk=0.1)
    arrived = log["arrived"].tolist().index(1.0)
    assert log["problems"].tolist() == [1] * (arrived + 1) + [0] * (5 - arrived)


@pytest.mark.parametrize(
    "settings",
    [{"observe": False}, {"rule": "scan"}, {"comparison": "joint"}, {"first_edges": "shared", "observe": False}, {"dominance": "pareto"}],
)
def test_settings_of_rags_are_taken(settings):
    assert wb.run("uncertain-graph", policy="rags", seed=1, vertices=15, steps=10, **settings).iloc[-1]["arrived"] == 1.0


def test_where_nothing_is_observed_rags_walks_one_path_whatever_comes():
    played = UncertainGraphMission()
    paths = []
    for seed in (1, 2):
        world = played.world(seed, vertices=25, observe=False)
        for _ in range(14):
            world.step(played.policies()["rags"](world.observe()))
        paths.append(world.path)
    assert paths[0] == paths[1]


def test_unknown_settings_and_risks_are_refused():
    check_refused(UsageError, "risk must lie between 0 and 0", wb.run, "uncertain-graph", policy="rags", risk=0.7)
    check_refused(UsageError, "has no setting 'wind'", wb.run, "uncertain-graph", policy="rags", wind=1)


def test_it_can_be_filmed(filmed, tmp_path):
    film = filmed("uncertain-graph", policy="rags", steps=3, seed=1, vertices=15)
    film.save(tmp_path / "film.gif")
    scene = film.mission.scene(film.mission.world(1, vertices=15))
    assert scene.marked.sum() == 1
    assert np.isfinite(scene.area).all()
