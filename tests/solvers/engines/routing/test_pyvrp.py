import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import small

import waybound as wb
from waybound import Objective, TotalCost, UsageError, Vehicles
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.routing.integer_scales import UNLIMITED
from waybound.solvers.engines.routing.pyvrp import MAX_PENALTY, Model, PyVRP, load_factor
from waybound.solvers.engines.routing.routing_integers import integer_routing, with_slope


def test_options_reach_their_group() -> None:
    problem = small("capacity", 0, "round")
    result = PyVRP().run(problem, Options(iterations=20, extra={"ils.history_length": "50", "neighbourhood.num_neighbours": 3}), Control())
    assert result.status == "feasible"


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ({"ils.history_length": "long"}, "takes a whole number"), ({"ils.exhaustive_on_best": "perhaps"}, "takes a truth value"),
        ({"penalty.target_feasible": 7}, "target_feasible"), ({"seed": 3}, "no option 'seed'"),
    ],
)  # fmt: skip
def test_wrong_options_are_refused(extra, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        PyVRP().run(small("capacity", 0, "round"), Options(extra=extra), Control())


def test_seeds_matter_and_repeat() -> None:
    problem = small("heterogeneous-fleet", 1, "exact")
    answers = [PyVRP().run(problem, Options(iterations=1, seed=s), Control()).answer for s in (1, 1, 2, 3, 4, 5)]
    assert answers[0] == answers[1]
    assert len(set(map(str, answers))) > 1


def test_it_tells_when_its_search_begins_and_runs_apart_where_its_set_up_holds_everything_up() -> None:
    problem, control = small("capacity", 0, "exact"), Control()
    assert PyVRP().run(problem, Options(iterations=3), control).answer is not None
    assert control.set_up is not None and not control.setting_up
    assert not PyVRP().apart(problem)
    assert PyVRP().memory(problem) == 35.0 * problem.size**2


def test_whole_data_are_handed_over_as_they_are() -> None:
    problem = small("time-windows", 0, "round")
    made = Model(problem, integer_routing(problem))
    model = made.data
    assert made.types == [0]
    assert (model.distance_matrix(0) == problem.travel.distances).all()
    assert [c.delivery for c in model.clients()] == [[int(d)] for d in problem.sites.demand[1:]]
    assert [(c.tw_early, c.tw_late) for c in model.clients()] == [
        (int(r), int(d)) for r, d in zip(problem.sites.ready[1:], problem.sites.due[1:], strict=True)
    ]
    assert model.vehicle_type(0).num_available == len(problem.customers)
    assert model.vehicle_type(0).tw_late == UNLIMITED


def test_a_unit_of_load_is_never_cheaper_to_carry_too_much_than_a_detour() -> None:
    for convention in ("round", "trunc1", "exact"):
        for objective in (TotalCost(), Vehicles().then(TotalCost())):
            problem = replace(small("capacity", 0, convention), objective=Objective.of(objective))
            data = integer_routing(problem)
            gain = max(int(data.moves[0].distance.max()) * int(data.unit.max()), int(data.fixed.max()))
            assert load_factor(data) * MAX_PENALTY >= 10 * gain


def test_loads_keep_their_scale_where_costs_are_small() -> None:
    assert load_factor(integer_routing(small("capacity", 0, "round"))) == 1


def test_energy_for_travel_is_a_limit_on_distance_in_the_distances_scale() -> None:
    problem = small("travel", 0, "trunc1")
    problem = replace(problem, sites=replace(problem.sites, service=np.where(problem.sites.depot, 0.0, 0.25)))
    data = integer_routing(problem)
    assert (data.scales["time"], data.scales["distance"]) == (100, 10)
    model = Model(problem, data).data
    energy = problem.fleet[0].energy
    assert model.vehicle_type(0).max_distance == math.floor(energy.capacity / energy.rate * 10 + 1e-9)


def test_durations_are_made_only_where_time_is_limited_or_priced() -> None:
    plain = small("capacity", 0, "exact")
    data = integer_routing(plain)
    made = Model(plain, data).data
    assert "duration" not in vars(data.moves[0])
    assert np.array_equal(made.duration_matrix(0), made.distance_matrix(0))
    for timed in (
        replace(plain, fleet=(replace(plain.fleet[0], max_duration=1e6),)),
        replace(plain, fleet=(replace(plain.fleet[0], unit_duration_cost=2.0),)),
        replace(plain, sites=replace(plain.sites, due=np.where(plain.sites.depot, np.inf, 1e6))),
    ):
        data = integer_routing(timed)
        assert np.array_equal(Model(timed, data).data.duration_matrix(0), data.moves[0].duration)


def test_what_it_prices_of_loads_of_many_digits_stays_within_64_bits() -> None:
    """Where moves cost nothing but a slope is given, too: beyond, its search does not end."""
    xy = np.array([[0, 0], [7167.008092, 0], [0, 2430.080372], [7167.008092, 1.25]])
    sites = wb.Sites.of(range(4), demand=[0.0, 4876.50624215, 6591.62708919, 10109.29279748], coordinates=xy)
    vehicle = wb.VehicleType(capacity=11690.64392067265, max_distance=15380.75408837651, fixed_cost=1e-7, unit_cost=0.0)
    problem = wb.RoutingProblem(sites, wb.Travel("euclidean", xy), (vehicle,))
    data = with_slope(problem, integer_routing(problem))
    assert load_factor(data) * int(data.demand.sum()) * MAX_PENALTY <= UNLIMITED
    assert PyVRP().run(problem, Options(iterations=30, time_limit=60.0), Control()).limit == "iterations"


def test_lengths_that_only_break_ties_have_no_more_digits_than_that_takes() -> None:
    """So that no reward outweighs what is paid for a limit that is not kept."""
    problem = small("reward", 0, "exact")
    free = replace(problem, fleet=tuple(replace(v, max_distance=math.inf, max_duration=100.0, energy=None) for v in problem.fleet))
    assert with_slope(free, integer_routing(free)).moves[0].longest <= 1 << 20 < integer_routing(free).moves[0].longest
    limited = replace(problem, fleet=tuple(replace(v, max_distance=100.0) for v in problem.fleet))
    assert with_slope(limited, integer_routing(limited)).moves[0].longest == integer_routing(limited).moves[0].longest
