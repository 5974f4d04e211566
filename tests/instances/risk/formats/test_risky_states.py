from pathlib import Path

import pytest
from file_cases import refused

import waybound as wb
from waybound.instances.formats import FORMATS

TABLE = """# conditional: yes
# reach: 1.2
# start: a
# goals: d; c
# length: 0.02 linear
state,easting,northing,reward,risk-distance,risk-view
a,0,0,0,0.01,0
b,1,0,2,0.04,0.02
c,0,1,0,0,0.01
d,1,1,0,0,0.02
"""


def read(text: str):
    return FORMATS["risk-states"].read(text, Path("states.csv"))


def test_states_within_reach_are_neighbours():
    graph = read(TABLE)
    assert (graph.name, len(graph.tail), graph.goals, [e.label for e in graph.elements]) == (
        "states", 8, (3, 2), ["distance", "view", "length"],
    )  # fmt: skip
    assert graph.rewards.tolist() == [0, 2, 0, 0]
    assert len(read(TABLE.replace("1.2", "1.5")).tail) == 12


def test_heights_and_one_column_of_risk():
    graph = read("# conditional: no\n# reach: 2\n# start: a\nstate,easting,northing,height,risk,reward\na,0,0,0,0.1,0\nb,0,0,1,0.2,1\n")
    assert graph.positions.tolist() == [[0, 0, 0], [0, 0, 1]] and graph.elements[0].label == "risk"


def test_it_is_recognised_and_solved(tmp_path):
    (tmp_path / "states.csv").write_text(TABLE)
    problem = wb.read(tmp_path / "states.csv")
    assert problem.answer_to_json(wb.solve(problem).answer) == {"kind": "path", "vertices": ["a", "c"]}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("a,0,0,0,0.01,0", "a,0,0,0,1.5,0"), "line 7: risk-distance must lie in [0, 1]; found '1.5'"),
        (("a,0,0,0,0.01,0", "a,0,?,0,0.01,0"), "line 7: northing must be a finite number"),
        (("# start: a\n", ""), "line 1: setting start is missing"),
        (("# reach: 1.2\n", ""), "line 1: setting reach is missing"),
        (("# reach: 1.2", "# reach: 0"), "line 2: the reach of a move must be positive"),
        (("# goals: d; c", "# goals: z"), "line 4: the goal 'z' is no state"),
        (("# start: a", "# start: a, b"), "line 3: there must be one start; found 2"),
        (("b,1,0", "b,1e200,0"), "places and reach are too large for distances; expected at most 1e+150; found 1e+200"),
        (("b,1,0", "a,1,0"), "two states have the name 'a'"),
        (("# goals: d; c", "# luck: d"), "line 4: setting 'luck' is unknown"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(change, message):
    assert message in refused(read, TABLE.replace(*change))
