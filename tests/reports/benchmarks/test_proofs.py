from dataclasses import replace

import pytest

from waybound.api import solve
from waybound.reports.battery.cases import Draw, cases
from waybound.reports.battery.truth import Truth
from waybound.reports.benchmarks import proofs
from waybound.reports.benchmarks.proofs import FALSE, VERIFIED, beside_highs, main, set_cover, verified_of_battery


@pytest.mark.slow
def test_what_is_verified_is_counted_by_kind(capsys: pytest.CaptureFixture[str]) -> None:
    assert verified_of_battery(19, 10.0, 1) == 0
    said = capsys.readouterr().out
    assert "19 of 19 verified, 0 false" in said and "not verified" not in said
    assert said.count("1 of 1") == 19


def test_a_false_word_is_found_out() -> None:
    case = next(c for c in cases(Draw(50)) if c.kind == "integer" and c.truth.value is not None)
    found = solve(case.problem.compile(), "highs", bound_time=10.0)
    assert case.truth.value is not None
    assert proofs._verdict(found, case.truth) == VERIFIED
    worse = 1000 if case.problem.sense == "max" else -1000
    assert proofs._verdict(found, Truth("optimal", case.truth.value + worse)) == FALSE
    assert proofs._verdict(found, Truth("infeasible")) == FALSE
    assert proofs._verdict(replace(found, bound_kind="claimed"), case.truth) == "not verified"


def test_the_command_ends_well(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.argv", ["proofs", "--battery", "2", "--winner-takes-all", "1", "--covers", "0", "--leaves", "100"])
    assert main() == 0
    said = capsys.readouterr().out
    assert "leaves  proved" in said and "for 100 leaves of a program of 100 rows" in said


def test_covers_are_drawn_and_proved(capsys: pytest.CaptureFixture[str]) -> None:
    assert set_cover(3).digest() == set_cover(3).digest() != set_cover(4).digest()
    small = set_cover(1, 20, 60, 0.1)
    assert small.program.matrix.sum(axis=1).min() >= 2
    beside_highs("covers", [("small", small)])
    assert capsys.readouterr().out.rstrip().endswith("yes")
