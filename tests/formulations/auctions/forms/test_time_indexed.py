from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from coded import coded
from draws import draws
from orchard_cases import ONE_ROUTE, SCHEDULES, lane, random_jobs, retrievals
from program_text import expected, written

import waybound as wb
from waybound.formulations.auctions.forms.time_indexed import MOST_STARTS, full_at
from waybound.instances.errors import InputError, UnsupportedError

ORCHARD = """
    {"waybound": 1, "kind": "orchard-jobs", "name": "orchard", "problem": "orchard-day",
     "orchard": {"rows": 5, "columns": 10, "repository": 0, "empty_speed": 2, "full_speed": 1},
     "robots": {"row": [0, 0], "column": [0, 1], "free": [0, 0]},
     "bins": {"row": [0, 1], "column": [2, 1], "after": [0, 0], "standing": [true, true], "work": [0, 3]},
     "settings": {"objective": "makespan"}}
"""


def test_time_indexed_from_text_to_text(tmp_path: Path) -> None:
    """Both bins are a step out and two home, the second full at step 3; the second robot is in the field, a step from home."""
    assert written(ORCHARD, "time-indexed", tmp_path, ".json") == expected("""
        time-indexed, exact
        min C
        fetched[1]: x[1,0] + x[1,1] + x[1,2] + y[2,1] = 1
        fetched[2]: x[2,2] + y[2,2] = 1
        first[2]: y[2,1] + y[2,2] + g[2] = 1
        away[0]: x[1,0] + y[2,1] + y[2,2] + g[2] <= 2
        away[1]: x[1,0] + x[1,1] + y[2,1] + y[2,2] <= 2
        away[2]: x[1,0] + x[1,1] + x[1,2] + x[2,2] + y[2,1] + y[2,2] <= 2
        away[3]: x[1,1] + x[1,2] + x[2,2] + y[2,2] <= 2
        away[4]: x[1,2] + x[2,2] + y[2,2] <= 2
        last[1]: 3 x[1,0] + 4 x[1,1] + 5 x[1,2] + 3 y[2,1] - C <= 0
        last[2]: 5 x[2,2] + 5 y[2,2] - C <= 0
        x[1,0], x[1,1], x[1,2], x[2,2], y[2,1], y[2,2], g[2] binary
        0 <= C <= 5
    """)


def test_a_sum_of_steps_has_no_last_one_and_more_time(tmp_path: Path) -> None:
    text = written(ORCHARD.replace("makespan", "completion"), "time-indexed", tmp_path, ".json")
    assert text.startswith("time-indexed, exact\nmin 3 x[1,0] + 4 x[1,1] +") and "last[" not in text and "away[6]" in text


@pytest.mark.parametrize("solver", ["highs", "cpsat"])
@pytest.mark.parametrize("name", SCHEDULES)
def test_worked_days(name: str, solver: str) -> None:
    cells, full, robots, _, makespan, completion = SCHEDULES[name]
    for objective, value in (("makespan", makespan), ("completion", completion)):
        found = wb.solve(retrievals(cells, full, robots, objective), solver, form="time-indexed", bound_time=60.0)
        assert (found.status, found.objective) == ("optimal", value)


def test_programs_and_intervals_agree_and_answers_are_points() -> None:
    rng = np.random.default_rng(3)
    for _ in range(draws(20)):
        jobs = random_jobs(rng, int(rng.integers(1, 4)), int(rng.integers(1, 6)))
        jobs = replace(jobs, standing=np.ones(jobs.num_bins, bool))
        for objective in ("makespan", "completion"):
            problem = wb.OrchardDay(jobs, objective)
            best = wb.solve(problem, "interval-scheduling", bound_time=60.0)
            assert wb.solve(problem, "highs", form="time-indexed", bound_time=60.0).objective == best.objective
            made = problem.compile("time-indexed")
            vector = made.encode(best.answer)
            assert made.program.residual(vector) == 0.0 and made.program.cost @ vector == best.objective
            assert problem.evaluate(made.decode(vector)).values[0] == best.objective


def test_chains_of_bins_are_full_one_after_the_other() -> None:
    jobs = random_jobs(np.random.default_rng(1), 2, 5)
    full = full_at(wb.OrchardDay(replace(jobs, standing=np.ones(5, bool))))
    assert all(full[k] == jobs.work[k] + (full[b] if b >= 0 else 0) for k, b in enumerate(jobs.after.tolist()))


def test_days_with_bins_to_bring_and_long_ones_are_refused() -> None:
    with pytest.raises(UnsupportedError, match="bins to be brought"):
        wb.OrchardDay(wb.OrchardJobs.of_routes(lane(ONE_ROUTE, 2), ONE_ROUTE)).compile("time-indexed")
    late = retrievals(((0, 2),), (MOST_STARTS,))
    with pytest.raises(UnsupportedError, match="pairs of bin and step"):
        late.compile("time-indexed")


def test_a_plan_that_idles_too_long_is_no_point() -> None:
    problem = retrievals(((0, 2), (4, 8)), (0, 0), ((0, 0), (0, 0)))
    with pytest.raises(InputError, check=coded("unsupported")):
        problem.compile("time-indexed").encode((((-1, 0), (-1, 1)), ()))
