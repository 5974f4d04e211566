from pathlib import Path

import numpy as np
from coded import check_coded
from draws import draws
from explorations import path, random_map
from file_cases import check_refused
from program_text import expected, written

import waybound as wb
from waybound.instances.errors import InputError, UnsupportedError

HALL = """
    {"waybound": 1, "kind": "exploration-map", "name": "hall", "problem": "room-exploration",
     "rooms": {"count": 2, "name": ["h", "a"], "exploring": [[0.5], [4]], "mapping": [[0], [2]], "searching": [[0], [3]]},
     "doors": [[0, 1]], "robots": [0, 0], "base": 0, "heard": [], "silence": 0, "steps": 1}
"""


def test_time_expanded_from_text_to_text(tmp_path: Path) -> None:
    """Two robots in the hall, one step, nobody heard in the other room."""
    assert written(HALL, "time-expanded", tmp_path, ".json") == expected("""
        time-expanded, exact
        max 0.5 z-go[h,0] + 4 z-go[a,0] + 2 z-map[a,0] + 3 z-search[a,0]
        start[0]: m[1,h,a,go,1] + m[1,h,h,go,1] + m[1,h,h,map,1] + m[1,h,h,search,1] = 1
        start[1]: m[2,h,a,go,1] + m[2,h,h,go,1] + m[2,h,h,map,1] + m[2,h,h,search,1] = 1
        elsewhere[0]: m[1,a,h,go,1] + m[1,a,a,go,1] + m[1,a,a,map,1] + m[1,a,a,search,1] = 0
        elsewhere[1]: m[2,a,h,go,1] + m[2,a,a,go,1] + m[2,a,a,map,1] + m[2,a,a,search,1] = 0
        gain[0]: - m[1,a,h,go,1] - m[2,a,h,go,1] + z-go[h,0] <= 0
        gain[1]: - m[1,h,a,go,1] - m[2,h,a,go,1] + z-go[a,0] <= 0
        gain[2]: - m[1,h,h,map,1] - m[2,h,h,map,1] + z-map[h,0] <= 0
        gain[3]: - m[1,a,a,map,1] - m[2,a,a,map,1] + z-map[a,0] <= 0
        gain[4]: - m[1,h,h,search,1] - m[2,h,h,search,1] + z-search[h,0] <= 0
        gain[5]: - m[1,a,a,search,1] - m[2,a,a,search,1] + z-search[a,0] <= 0
        base[0]: - 2 m[1,a,h,go,1] - 2 m[1,h,h,go,1] - 2 m[1,h,h,map,1] - 2 m[1,h,h,search,1] + b[1,0] <= 0
        base[1]: - 2 m[2,a,h,go,1] - 2 m[2,h,h,go,1] - 2 m[2,h,h,map,1] - 2 m[2,h,h,search,1] + b[2,0] <= 0
        link[0]: f[1,2,1] - 2 c[1,2,1] <= 0
        link[1]: f[2,1,1] - 2 c[2,1,1] <= 0
        hears[0]: m[1,a,h,go,1] + m[1,h,h,go,1] + m[1,h,h,map,1] + m[1,h,h,search,1] - m[2,a,h,go,1] - m[2,h,h,go,1] -
            m[2,h,h,map,1] - m[2,h,h,search,1] + c[1,2,1] <= 1
        hears[1]: m[1,h,a,go,1] + m[1,a,a,go,1] + m[1,a,a,map,1] + m[1,a,a,search,1] - m[2,h,a,go,1] - m[2,a,a,go,1] -
            m[2,a,a,map,1] - m[2,a,a,search,1] + c[1,2,1] <= 1
        hears[2]: - m[1,a,h,go,1] - m[1,h,h,go,1] - m[1,h,h,map,1] - m[1,h,h,search,1] + m[2,a,h,go,1] + m[2,h,h,go,1] +
            m[2,h,h,map,1] + m[2,h,h,search,1] + c[2,1,1] <= 1
        hears[3]: - m[1,h,a,go,1] - m[1,a,a,go,1] - m[1,a,a,map,1] - m[1,a,a,search,1] + m[2,h,a,go,1] + m[2,a,a,go,1] +
            m[2,a,a,map,1] + m[2,a,a,search,1] + c[2,1,1] <= 1
        flow[0]: - K[1,0] + b[1,0] - f[1,2,1] + f[2,1,1] = 0
        flow[1]: - K[2,0] + b[2,0] + f[1,2,1] - f[2,1,1] = 0
        contact[0]: K[1,0] >= 1
        contact[1]: K[2,0] >= 1
        end[0]: K[1,0] = 1
        end[1]: K[2,0] = 1
        m[1,h,a,go,1], m[1,a,h,go,1], m[1,h,h,go,1], m[1,a,a,go,1], m[1,h,h,map,1], m[1,a,a,map,1], m[1,h,h,search,1],
            m[1,a,a,search,1], m[2,h,a,go,1], m[2,a,h,go,1], m[2,h,h,go,1], m[2,a,a,go,1], m[2,h,h,map,1], m[2,a,a,map,1],
            m[2,h,h,search,1], m[2,a,a,search,1], K[1,0], K[2,0], c[1,2,1], c[2,1,1] binary
        0 <= z-go[h,0], z-go[a,0], z-map[h,0], z-map[a,0], z-search[h,0], z-search[a,0] <= 1
        0 <= b[1,0], b[2,0], f[1,2,1], f[2,1,1] <= 2
    """)


def test_steps_are_joined_and_each_silence_is_as_long_as_allowed(tmp_path: Path) -> None:
    text = written(HALL.replace('"silence": 0, "steps": 1', '"silence": 1, "steps": 3'), "time-expanded", tmp_path, ".json")
    assert "contact[0]: K[1,0] + K[1,1] >= 1" in text and "contact[1]: K[1,1] + K[1,2] >= 1" in text and "end[0]: K[1,2] = 1" in text
    assert "keep[7]" in text and "keep[8]" not in text


def test_answers_are_points_and_points_answers() -> None:
    rng = np.random.default_rng(5)
    for _ in range(draws(12)):
        problem = random_map(rng)
        made = problem.compile("time-expanded")
        for answer in (problem.answer_at_hand(), wb.solve(problem, heuristic="heard-greedy", bound_time=0).answer):
            vector = made.encode(answer)
            assert made.program.residual(vector) == 0.0 and made.decode(vector) == answer
            assert made.program.cost @ vector == problem.evaluate(answer).values[0]


def test_contact_over_a_relay_is_a_flow() -> None:
    problem = path(4, 0, 3, 2, 2, heard=((0, 1), (1, 2)))
    answer = (((1, 0), (1, 0), (0, 0)), ((1, 0), (2, 0), (1, 0)))
    made = problem.compile("time-expanded")
    vector = made.encode(answer)
    assert made.program.residual(vector) == 0.0
    named = {made.program.variable_name(k): vector[k] for k in np.nonzero(vector)[0].tolist()}
    assert named["f[1,2,2]"] == 1.0 and named["c[1,2,2]"] == 1.0


def test_what_breaks_a_rule_is_no_point_and_too_large_maps_are_refused() -> None:
    problem = path(3, 0, 2)
    check_coded(InputError, "unsupported", problem.compile("time-expanded").encode, (((1, 0), (0, 0)),))
    check_refused(UnsupportedError, "moves", path(200, 0, 1000).compile, "time-expanded")
