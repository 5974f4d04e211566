import numpy as np
import risky_cases as cases

import waybound as wb
from waybound.reports.plots import PLOTS

draw = PLOTS["risky-path"]


def test_a_map_shows_the_path_coloured_by_the_risk_until_then():
    problem = wb.generate("risky-grid", rows=5, columns=6, tether=True)
    solution = wb.solve(problem, bound_time=0)
    ax = draw(problem, solution.answer, solution=solution)
    (path,) = (lines for lines in ax.collections if lines.__class__.__name__ == "LineCollection")
    risk = problem.answer_to_frame(solution.answer)["risk"].to_numpy()
    assert np.allclose(path.get_array(), risk[1:])
    assert [tuple(segment[0]) for segment in path.get_segments()] == [tuple(p) for p in problem.graph.positions[list(solution.answer[:-1])]]
    assert len(ax.lines) == 1  # the tether


def test_states_without_places_are_bars_of_their_risks():
    ax = draw(cases.of_table(cases.GREEN), tuple(range(8)))
    assert len(ax.patches) == 6 * 8
    assert np.allclose(ax.lines[0].get_ydata()[-1], 0.5752245813)
