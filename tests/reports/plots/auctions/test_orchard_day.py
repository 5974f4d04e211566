from orchard_cases import TWO_ROUTES, lane

import waybound as wb


def test_every_bin_is_a_bar_and_named():
    problem = wb.OrchardDay(wb.OrchardJobs.of_routes(lane(TWO_ROUTES, 2), TWO_ROUTES))
    found = wb.solve(problem, heuristic="list-schedule", bound_time=0)
    ax = found.plot()
    home = problem.timetable(found.answer)
    ends = {round(bar.get_x() + bar.get_width()) for bar in ax.patches}
    assert set(home.tolist()) <= ends
    assert {str(k + 1) for k in range(8)} <= {text.get_text() for text in ax.texts}
    told = {text.get_text() for text in ax.get_legend().get_texts()}
    assert told == {"home with a bin", "out with a new bin", "out without one"}
