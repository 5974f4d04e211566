import itertools

import numpy as np
import pytest
from coded import check_coded, coded
from draws import draws
from file_cases import check_refused
from orchard_cases import FOUR, LANE, ONE_ROUTE, SCHEDULES, TWO_ROUTES, WHOLE_DAYS, lane, random_jobs, retrievals

import waybound as wb
from waybound import InputError, OrchardJobs, UsageError
from waybound.formulations.auctions.orchard_day import OrchardDay, in_order
from waybound.formulations.evidence import CHECKERS
from waybound.formulations.problem import problem_from_instance
from waybound.instances.auctions.orchard_rules import OrchardRules, draw_routes
from waybound.instances.generators import Draw
from waybound.reports.missions.auctions.orchard_days.days import play_day

EIGHT_BINS = OrchardJobs.of_routes(lane(TWO_ROUTES, 2), TWO_ROUTES)


@pytest.mark.parametrize(("places", "full", "robots", "ways", "last", "total"), SCHEDULES.values())
def test_schedules_of_the_reference(places, full, robots, ways, last, total):
    jobs = retrievals(places, full, robots).jobs
    assert tuple((jobs.out + jobs.home).tolist()) == ways
    for objective, value in (("makespan", last), ("completion", total)):
        found = wb.solve(retrievals(places, full, robots, objective), bound_time=0)
        assert (found.objective, found.status) == (value, "optimal")
        assert CHECKERS["retrievals"](retrievals(places, full, robots, objective), {}) <= value


@pytest.mark.parametrize(("start", "robots", "last", "optimum"), WHOLE_DAYS)
def test_whole_days_of_the_reference(start, robots, last, optimum):
    rules = lane(start, robots)
    found = wb.solve(OrchardDay(OrchardJobs.of_routes(rules, start)), bound_time=0)
    assert (found.objective, found.status) == (optimum, "optimal")


@pytest.mark.parametrize("seed", range(3))
def test_no_rule_beats_the_optimum_of_a_small_orchard(seed):
    problem = wb.generate("orchard-day", seed=seed, rows=2, columns=4, robots=2)
    jobs, best = problem.jobs, wb.solve(problem, bound_time=0).objective
    rules = OrchardRules(jobs.grid, 2, 2, 1)
    start = draw_routes(rules, Draw(np.random.Generator(np.random.PCG64(seed))))
    assert OrchardJobs.of_routes(rules, start).digest() == jobs.digest()
    assert min(play_day(rules, 1, *how, start=start).makespan for how in FOUR) >= best


def every_answer(jobs):
    """All ways to share out and order trips."""
    brought = [k for k in range(jobs.num_bins) if not jobs.standing[k]]
    for partners in itertools.product([-1, *range(jobs.num_bins)], repeat=len(brought)):
        used = [b for b in partners if b >= 0]
        if len(set(used)) < len(used):
            continue
        by = dict(zip(partners, brought, strict=True))
        all_trips = [(by.get(b, -1), b) for b in range(jobs.num_bins)] + [(a, -1) for a, b in zip(brought, partners, strict=True) if b < 0]
        for order in itertools.permutations(all_trips):
            for cuts in itertools.combinations_with_replacement(range(len(order) + 1), jobs.num_robots - 1):
                ends = (0, *cuts, len(order))
                yield tuple(order[ends[r] : ends[r + 1]] for r in range(jobs.num_robots))


@pytest.mark.parametrize("objective", ["makespan", "completion"])
def test_the_engine_finds_what_trying_all_answers_finds(objective):
    rng = np.random.default_rng(11)
    for _ in range(draws(20)):
        problem = OrchardDay(random_jobs(rng, robots=2, bins=2), objective)
        values = [e.values[0] for e in map(problem.evaluate, every_answer(problem.jobs)) if e.feasible]
        found = wb.solve(problem, bound_time=0)
        assert (found.objective, found.status, found.faults) == (min(values), "optimal", ())
        assert CHECKERS["retrievals"](problem, {}) <= min(values)
        assert problem.evaluate(problem.answer_at_hand()).feasible


def test_larger_days_are_optimal_and_judged():
    rng = np.random.default_rng(5)
    for _ in range(draws(10)):
        problem = OrchardDay(random_jobs(rng, robots=3, bins=6))
        found = wb.solve(problem, time_limit=20, bound_time=0)
        assert found.certificate.feasible
        assert CHECKERS["retrievals"](problem, {}) <= found.objective <= problem.evaluate(problem.answer_at_hand()).objective


def test_a_timetable_by_hand():
    problem = OrchardDay(OrchardJobs.of_routes(lane(ONE_ROUTE, 1), ONE_ROUTE))
    one_by_one = (((1, 0), *((k, k - 1) for k in range(2, 8)), (-1, 7)),)
    assert problem.evaluate(one_by_one).feasible
    # full at 2, home 3; to cell 2 at 4 and back to 1 at 5, where the next one is full since 4
    assert problem.timetable(one_by_one).tolist()[:2] == [3, 6]
    each = (tuple((k if k else -1, k) for k in range(8)),)
    assert problem.timetable(each).tolist() == [3, 7, 12, 17, 24, 31, 39, 47]


def test_what_is_wrong_with_an_answer_is_told():
    problem = OrchardDay(EIGHT_BINS)
    good = in_order(problem.jobs, range(8))
    assert problem.evaluate(good).feasible
    for trips in (good[0][:-1], good[0] + good[0][:1]):
        assert {v.check for v in problem.evaluate((trips, good[1])).violations} >= {"fetched"}
    deadlock = problem.evaluate((((-1, 1), (1, -1)), ()))
    assert "waits" in {v.check for v in deadlock.violations}
    assert "robot 1 waits for a bin that is never full" in {v.message for v in deadlock.violations}


@pytest.mark.parametrize(
    ("answer", "code"),
    [
        (None, "malformed"), ((), "malformed"), (((),), "malformed"), ((((0, 9),), ()), "out-of-range"),
        ((((-1, -1),), ()), "out-of-range"), (([(0, 0)], ()), "malformed"), ((((0, True),), ()), "out-of-range"),
    ],
)  # fmt: skip
def test_what_is_no_answer_is_refused(answer, code):
    problem = OrchardDay(EIGHT_BINS)
    with pytest.raises(InputError, check=coded(code)):
        problem.evaluate(answer)


def test_answers_go_through_json_and_frames():
    problem = OrchardDay(EIGHT_BINS)
    answer = in_order(problem.jobs, range(8))
    assert problem.answer_from_json(problem.answer_to_json(answer)) == answer
    frame = problem.answer_to_frame(answer)
    assert len(frame) == 8
    assert frame["home"].max() == problem.evaluate(answer).objective
    for data in ({}, {"kind": "trips", "robots": [1]}, {"kind": "trips", "robots": [[{"bring": 0, "fetch": 1}], []]}):
        with pytest.raises(InputError):
            problem.answer_from_json(data)


def test_settings_are_checked():
    jobs = OrchardJobs.of_routes(lane(ONE_ROUTE, 1), ONE_ROUTE)
    check_refused(UsageError, "objective must be one of makespan, completion", OrchardDay, jobs, "cost")
    check_coded(UsageError, "malformed", OrchardDay, LANE)
    assert problem_from_instance(jobs, objective="completion").objective == "completion"
    with pytest.raises(UsageError, match="has no setting 'robots'; it takes objective"):
        problem_from_instance(jobs, robots=3)
