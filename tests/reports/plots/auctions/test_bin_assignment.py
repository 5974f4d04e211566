import numpy as np
import pytest
from bin_assignments import worked
from matplotlib.colors import to_rgb

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.instances.generating import generate
from waybound.reports.plots.auctions.bin_assignment import places
from waybound.reports.plots.drawing import ALARM


def test_each_pair_is_a_line_between_positions_or_columns() -> None:
    for problem in (worked("E"), BinAssignment(generate("assignment", 1, robots=3, bins=5, costs="euclidean"))):
        ax = wb.solve(problem).plot()
        lines = ax.collections[0].get_segments()
        assert len(lines) == problem.pairs
        robots, bins = places(problem)
        assert all(tuple(a) in set(map(tuple, robots)) and tuple(b) in set(map(tuple, bins)) for a, b in lines)
        assert any("pairs of" in text.get_text() for text in ax.texts)


def test_positions_are_those_of_the_data() -> None:
    data = generate("assignment", 1, robots=3, bins=5, costs="orchard")
    assert places(BinAssignment(data)) == (data.robot_positions, data.bin_positions)


def test_of_a_bottleneck_the_dearest_pairs_are_red_and_named() -> None:
    given = worked("E").instance
    for objective in ("sum", "bottleneck"):
        problem = BinAssignment(given, objective=objective)
        solution = wb.solve(problem)
        ax, costs = solution.plot(), problem.costs_of(solution.answer)
        red = [tuple(colour[:3]) == pytest.approx(to_rgb(ALARM)) for colour in ax.collections[0].get_colors().tolist()]
        assert red == [objective == "bottleneck" and cost == max(costs) for cost in costs[np.array(solution.answer) >= 0]]
        assert any("the dearest in red" in text.get_text() for text in ax.texts) is (objective == "bottleneck")
