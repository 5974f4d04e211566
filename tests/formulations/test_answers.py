import json

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

import waybound as wb
from waybound.formulations.answers import check_answer_path, read_answer, write_answer


@pytest.fixture(scope="module")
def solution():
    return wb.solve(wb.read("demo-tiny"), heuristic="savings", bound_time=0)


@pytest.mark.parametrize("suffix", [".sol", ".json"])
def test_an_answer_survives_its_file(solution, tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    write_answer(solution, path)
    read = read_answer(solution.problem, path)
    assert read.answer.canonical() == solution.answer.canonical()
    assert read.stated == pytest.approx(solution.objective, abs=1e-9)
    assert read.notes == ()


def test_a_tour_survives_its_file(tmp_path):
    problem = wb.generate("random", seed=5, customers=6, vehicles=1)
    assert isinstance(problem, wb.RoutingProblem)
    problem = wb.RoutingProblem(problem.sites, problem.travel, (wb.VehicleType(count=1),), name="one")
    solution = wb.solve(problem, "pyvrp", iterations=20, bound_time=0)
    write_answer(solution, tmp_path / "a.tour")
    assert read_answer(problem, tmp_path / "a.tour").answer == solution.answer


def test_a_bare_answer_is_read_too(solution, tmp_path):
    path = tmp_path / "a.json"
    path.write_text(json.dumps(solution.problem.answer_to_json(solution.answer)))
    read = read_answer(solution.problem, path)
    assert (read.answer, read.stated) == (solution.answer, None)


def test_an_answer_to_other_data_is_read_with_a_note(solution, tmp_path):
    write_answer(solution, tmp_path / "a.json")
    notes = read_answer(wb.read("demo-tiny", convention="trunc1"), tmp_path / "a.json").notes
    assert any("convention" in note and "exact" in note for note in notes)
    assert any("instance" in note for note in notes)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{"answer": null}', "no answer"), ('{"answer": {"kind": "prices"}}', "routing"),
        ('{"kind": "routes", "routes": [{"visits": ["nowhere"]}]}', "nowhere"), ('{"kind": "routes"', "JSON"), ("", "empty"),
        ("hello", "no solution file"), ('{"a": 1}', "JSON, but no solution"),
        ('{"waybound": 1, "kind": "routing"}', "JSON, but no solution"), ('{"kind": NaN}', "JSON"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_answer_is_refused_by_name(solution, tmp_path, text, says):
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(wb.InputError, match=says) as caught:
        read_answer(solution.problem, path)
    assert str(path) in str(caught.value)


SPOILT = '{"answer": {"kind": "routes", "routes": [{"visits": ["1", "2"], "vehicle": "vehicle"}]}, "objective": 12.5}'


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, len(SPOILT)), st.integers(0, 8), st.sampled_from(["", "{", "]", '"', "null", "1e999", "\x00"]) | st.text(max_size=8))
def test_a_spoilt_file_is_read_or_refused_with_its_name(solution, tmp_path, at, length, token):
    path = tmp_path / "spoilt.json"
    path.write_bytes((SPOILT[:at] + token + SPOILT[at + length :]).encode("utf-8", "surrogatepass"))
    try:
        read = read_answer(solution.problem, path)
    except wb.InputError as error:
        assert str(error).startswith(str(path)) and "\n" not in str(error)
    else:
        assert isinstance(read.answer, wb.Routes)


def test_answers_of_other_families_are_json_alone(tmp_path):
    problem = wb.read("cover-30")
    with pytest.raises(
        wb.UsageError, match=r"a\.sol: answers to selection problems are written as \.json, \.csv, \.xlsx, not under the suffix '\.sol'$"
    ):
        check_answer_path(problem, "a.sol")
    (tmp_path / "a.sol").write_text("Route #1: 1 2\n")
    with pytest.raises(wb.InputError, match=r"a\.sol:1: is no solution file of selection problems; expected JSON"):
        read_answer(problem, tmp_path / "a.sol")


def test_a_tour_cannot_hold_several_routes():
    with pytest.raises(wb.UsageError, match="one route"):
        check_answer_path(wb.read("demo-tiny"), "a.tour")


def test_an_unknown_suffix_names_the_known_ones():
    with pytest.raises(wb.UsageError, match=r"\.json, \.sol, \.tour"):
        check_answer_path(wb.read("demo-tiny"), "a.pdf")


def test_a_mixed_fleet_needs_json(tmp_path):
    problem = wb.read("demo-tiny")
    assert isinstance(problem, wb.RoutingProblem)
    mixed = wb.RoutingProblem(problem.sites, problem.travel, (wb.VehicleType(2, name="van"), wb.VehicleType(2, name="lorry")), name="mixed")
    with pytest.raises(wb.UsageError, match="vehicle types"):
        check_answer_path(mixed, "a.sol")
    (tmp_path / "a.sol").write_text("Route #1: 1\n")
    with pytest.raises(wb.UsageError, match="vehicle types"):
        read_answer(mixed, tmp_path / "a.sol")


@pytest.mark.parametrize("vehicle", [["x"], {}, 3, None, "truck\x1b[2J" * 50])
def test_a_vehicle_is_named_by_text(vehicle, tmp_path):
    (tmp_path / "a.json").write_text(json.dumps({"kind": "routes", "routes": [{"visits": ["1"], "vehicle": vehicle}]}))
    with pytest.raises(wb.InputError, match="names an unknown vehicle"):
        read_answer(wb.read("demo-tiny"), tmp_path / "a.json")
