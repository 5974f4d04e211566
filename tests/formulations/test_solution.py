import inspect
import pickle

import pytest

import waybound as wb
from waybound.formulations.certificate import Certificate
from waybound.formulations.solution import Solution, solution_lines, status_line


@pytest.fixture
def problem():
    return wb.read("demo-tiny")


def certificate(**changes):
    given = {"instance_hash": "sha256:0", "problem": "cvrp", "sense": "min", "convention": "exact", "feasible": True}
    return Certificate(**{**given, **changes})


def solution(problem, **changes):
    given = {
        "problem": problem, "answer": wb.Routes.of([[1]]), "status": "feasible", "limit": "none", "objective": 10.0, "bound": None,
        "bound_kind": None,
        "bound_source": None, "gap": None, "solver": "someone", "form": None, "seconds": {"solve": 1.0}, "seed": 1, "versions": {},
        "certificate": certificate(objective=10.0),
    }  # fmt: skip
    return Solution(**{**given, **changes})


REFUTED = certificate(feasible=None, infeasible=True, bound_source="no way to 7")


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"status": "optimal", "bound": 10.0, "bound_kind": "verified", "gap": 0.0}, "optimal: the verified bound meets the objective"),
        ({"status": "optimal", "bound": 10.0, "bound_kind": "claimed", "gap": 0.0}, "optimal according to someone"),
        ({"status": "optimal"}, "optimal according to someone"),
        ({"status": "feasible", "limit": "time"}, "feasible; stopped by the time limit"),
        ({"status": "feasible", "limit": "interrupt"}, "feasible; stopped by an interrupt"),
        ({"status": "infeasible", "answer": None}, "infeasible according to someone"),
        (
            {"status": "infeasible", "answer": None, "certificate": REFUTED},
            "infeasible, verified: no way to 7",
        ),
        ({"status": "unbounded", "answer": None}, "unbounded according to someone"),
        ({"status": "unknown", "answer": None, "limit": "time"}, "no answer; stopped by the time limit"),
    ],
)
def test_the_status_says_on_whose_word_it_rests(problem, changes, expected):
    assert status_line(solution(problem, **changes)).text == expected


def test_a_claimed_bound_is_told_apart_from_the_verified_one_beside_it(problem):
    both = certificate(objective=10.0, bound=8.0, bound_source="prices")
    lines = solution_lines(solution(problem, bound=9.5, bound_kind="claimed", bound_source="someone", gap=0.05, certificate=both))
    texts = [line.text for line in lines]
    assert any(t.startswith("9.5, claimed by someone") for t in texts)
    assert "8, verified: prices" in texts
    assert "5 %, against the claimed bound" in texts


def test_a_plot_is_explained_where_it_is_typed(problem):
    plot = solution(problem).plot
    assert list(inspect.signature(plot).parameters) == ["ax", "title", "options"]
    told = inspect.getdoc(plot)
    assert told is not None and "matplotlib.axes.Axes" in told


def test_without_an_answer_there_is_nothing_to_draw_or_to_tabulate(problem):
    empty = solution(problem, answer=None, status="unknown")
    for shown in (empty.plot, empty.to_frame):
        with pytest.raises(wb.NoAnswerError, match="found no answer"):
            shown()


def test_a_printed_solution_shows_its_routes_and_what_they_leave_out():
    import pandas as pd

    sites = pd.DataFrame({"name": ["Yard", "Aldi", "Bakery"], "x": [0, 3, 30], "y": 0, "required": [False, True, False]})
    asked = wb.RoutingProblem.from_frame(sites)
    text = str(solution(asked))
    assert "vehicle 1  Yard > Aldi > Yard (distance 6)" in text
    assert "left out   Bakery: in this answer inserting it" in text


def test_tables_routes_and_graph_of_an_answer(problem):
    made = solution(problem)
    assert made.routes == [("1",)] and made.routes[0].vehicle == "vehicle 1" and repr(made.routes) == "[['1']]"
    assert pickle.loads(pickle.dumps(made.routes))[0].vehicle == "vehicle 1"
    assert made.to_frame("visits").equals(made.to_frame()) and made.to_frame("routes")["stops"].tolist() == [1]
    assert made.to_frame("left-out").equals(made.left_out()) and len(made.left_out()) == 6
    assert made.to_networkx().number_of_edges() == 2
    with pytest.raises(wb.UsageError, match="there is no table of 'route'; choose from visits, routes, left-out; did you mean 'routes'"):
        made.to_frame("route")


def test_without_an_answer_there_is_nothing_to_save(problem, tmp_path):
    none = solution(problem, answer=None, status="unknown")
    for ask in (lambda: none.routes, lambda: none.save(tmp_path / "a.json"), none.to_networkx, none.to_frame):
        with pytest.raises(wb.NoAnswerError):
            ask()
    assert not list(tmp_path.iterdir())
