import numpy as np
import pytest
import risky_cases as cases
from coded import coded
from program_text import expected, written

import waybound as wb
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.errors import InputError, UnsupportedError
from waybound.solvers.linear_programs import LinearPrograms


@pytest.mark.parametrize("make", [cases.loop, cases.refusal, lambda: cases.ring(objective="hazard")], ids=["loop", "refusal", "ring"])
def test_the_optimum_is_that_of_all_paths(make):
    problem = make()
    solution = wb.solve(problem, "highs", form="consecutive-moves", bound_time=0)
    assert solution.objective == pytest.approx(cases.best(problem))


@pytest.mark.parametrize("seed", range(3))
def test_random_maps(seed):
    problem = cases.random_map(np.random.default_rng(seed), objective="hazard")
    assert wb.solve(problem, "highs", bound_time=0).objective == pytest.approx(cases.best(problem))


def test_a_path_is_a_point_of_its_own_value_and_comes_back():
    problem = cases.ring(objective="hazard")
    compiled = problem.compile("consecutive-moves")
    for path in cases.all_paths(problem):
        if problem.evaluate(path).feasible:
            x = compiled.encode(path)
            assert compiled.program.residual(x) == 0.0 and compiled.decode(x) == path
            assert compiled.program.value(x) == pytest.approx(problem.evaluate(path).values[0])
    with pytest.raises(InputError, check=coded("unknown-name")):
        compiled.encode((0, 7))


def test_a_loop_apart_is_left_out():
    problem = cases.loop()
    compiled, moves = problem.compile("consecutive-moves"), problem.moves
    x = compiled.encode((0, 1, 2))
    tail, head = problem.graph.tail, problem.graph.head
    around = np.isin(tail[moves.first], (1, 3, 4)) & np.isin(head[moves.second], (1, 3, 4)) & np.isin(head[moves.first], (3, 4))
    x[len(moves.begin) : len(moves.begin) + len(moves.first)][around] = 1.0
    assert compiled.decode(x) == (0, 1, 2)


def test_duals_prove_what_walks_do_not():
    for make, walks, best in ((cases.loop, 5, 12), (cases.refusal, 5, 6)):
        problem = make()
        compiled = problem.compile("consecutive-moves")
        evidence = compiled.dual_evidence(LinearPrograms().solve(compiled.relaxed().program).row_duals)
        assert walks + 0.5 < verified_bound(problem, evidence) <= best + 1e-9
        assert evidence.value == pytest.approx(verified_bound(problem, evidence))


def test_what_it_cannot_express_is_refused():
    with pytest.raises(UnsupportedError):
        cases.mud_costs().compile("consecutive-moves")
    with pytest.raises(UnsupportedError):
        cases.ring().compile("consecutive-moves")
    assert cases.ring((0, 0), "hazard").forms() == []


SQUARE = """
    # conditional: yes
    # objective: hazard
    # reach: 1.2
    # start: a
    # goals: d
    state,easting,northing,risk
    a,0,0,0
    b,1,0,0.5
    c,0,1,0.2
    d,1,1,0
"""


def test_consecutive_moves_from_text_to_text(tmp_path):
    assert written(SQUARE, "consecutive-moves", tmp_path) == expected("""
        consecutive-moves, exact
        min 0.693147 begin[a b] + 0.223144 begin[a c] + 0.223144 follow[b d,d c] + 0.693147 follow[c d,d b]
        start: begin[a b] + begin[a c] = 1
        flow[a b]: begin[a b] - follow[a b,b d] = 0
        flow[a c]: begin[a c] - follow[a c,c d] = 0
        flow[b a]: 0 = 0
        flow[b d]: follow[a b,b d] - follow[b d,d c] - end[b d] = 0
        flow[c a]: 0 = 0
        flow[c d]: follow[a c,c d] - follow[c d,d b] - end[c d] = 0
        flow[d b]: follow[c d,d b] = 0
        flow[d c]: follow[b d,d c] = 0
        visit[a]: 0 <= 1
        visit[b]: begin[a b] + follow[c d,d b] <= 1
        visit[c]: begin[a c] + follow[b d,d c] <= 1
        visit[d]: follow[a b,b d] + follow[a c,c d] <= 1
        begin[a b], begin[a c], follow[a b,b d], follow[a c,c d], follow[b d,d c], follow[c d,d b], end[b d], end[c d] binary
    """)
