from pathlib import Path

import pytest
from file_cases import refused

import waybound as wb
from waybound.instances.formats import FORMATS

MAP = """# risk map
# a corridor beside an open place
# conditional: yes
# name: yard
# cell: 0.5
# clearance: 0.04 0.5 1.5
# visibility: 0.02 0.5 2 8
# scale: 0.4 0.2 0.1
# length: 0.1
# turn: 0.02
# mud: 0.3
# tether: 0.25 0.25 0.01 0.03
...@G
.~~..
S..@.
"""


def read(text: str):
    return FORMATS["risk-map"].read(text, Path("yard.txt"))


def test_cells_marks_and_elements():
    graph = read(MAP)
    assert (graph.name, graph.num_states, graph.state_name(graph.start)) == ("yard", 13, "0,0")
    assert [graph.state_name(goal) for goal in graph.goals] == ["2,4"]
    assert [e.label for e in graph.elements] == ["clearance", "visibility", "scale", "length", "turn", "tether", "mud"]
    assert graph.positions[graph.start].tolist() == [0.25, 0.25]
    assert [graph.state_name(k) for k in graph.elements[-1].collects.nonzero()[0].tolist()] == ["1,1", "1,2"]


def test_digits_are_rewards_and_the_ratio_is_meant():
    graph = read("# risk map\n# conditional: no\n# connectivity: 4\n# length: 0.1\nS.3\n..7\n")
    assert (graph.objective, graph.rewards.tolist(), len(graph.tail)) == ("reward-per-risk", [0, 0, 7, 0, 0, 3], 14)


def test_it_is_recognised_and_solved(tmp_path):
    (tmp_path / "yard.txt").write_text(MAP)
    solution = wb.solve(wb.read(tmp_path / "yard.txt"), time_limit=10)
    assert (solution.status, solution.bound_kind) == ("optimal", "verified")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("S..@.", "...@."), "line 13: the map must hold one start S; found 0"),
        (("S..@.", "S..@"), "line 15: row has a wrong length; expected 5 cells; found 4 cells"),
        (("S..@.", "S.x@."), "line 15: the map holds 'x'; expected one of . @ S G ~"),
        (("# cell: 0.5", "# cell: -1"), "line 5: the side of a cell must be positive"),
        (("# cell: 0.5", "# connectivity: 6"), "line 5: cells of this map have no such number of neighbours; expected 4, 8; found 6"),
        (("0.04 0.5 1.5", "1.04 0.5 1.5"), r"line 6: a risk must lie in [0, 1]"),
        (("0.04 0.5 1.5", "0.04 0.5"), "line 6: clearance needs 3 numbers"),
        (("# mud: 0.3", "# mud: 3"), r"line 11: risks of mud must lie in [0, 1]"),
        (("# conditional: yes\n", ""), "it must be said whether risks are conditional"),
        (("# mud", "# luck"), "line 11: setting 'luck' is unknown"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(change, message):
    assert message in refused(read, MAP.replace(*change))
