from collections import Counter
from fractions import Fraction
from pathlib import Path

import pytest
from draws import draws

from waybound.reports.benchmarks import equal_answers as benchmark
from waybound.reports.benchmarks.routing_variants import TURNS, drawn, features_of, risky
from waybound.solvers.backend import BACKENDS

SOLVERS = [name for name in BACKENDS if BACKENDS[name].installed() and getattr(BACKENDS[name], "family", "routing") == "routing"]


def few(count: int, most: int) -> list[int]:
    """Numbers of the first problems of at most so many customers."""
    return [number for number in range(6 * count) if len(drawn(1, number).customers) <= most][:count]


@pytest.mark.share(2)
@pytest.mark.parametrize("turn", range(len(SOLVERS)))
def test_solvers_agree_with_enumeration_in_turn(turn: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark, "BOUND_TIME", 0.02)
    numbers = few(max(draws(64), 4 * len(SOLVERS)), 3)  # a few for each
    found = [benchmark.examined(k, drawn(1, k), SOLVERS[turn : turn + 1], heuristics=False) for k in numbers[turn :: len(SOLVERS)]]
    assert not [fault for record in found for fault in record.faults]
    assert {verdict for record in found for *_, verdict, _ in record.outcomes} >= {"agrees"}


@pytest.mark.long
@pytest.mark.parametrize("part", range(60))
def test_everything_agrees_with_enumeration(part: int) -> None:
    found = list(benchmark.records(1, range(50 * part, 50 * part + 50)))
    assert not [fault for record in found for fault in record.faults]


@pytest.mark.slow
def test_every_feature_is_drawn_thirty_times_in_a_thousand() -> None:
    counts = Counter(name for number in range(1000) for name in features_of(drawn(1, number)))
    assert min(counts[name] for name in TURNS) >= 30


def test_risks_are_drawn_in_turn_beside_other_features() -> None:
    counts = Counter(name for number in range(60) for name in features_of(risky(1, number)))
    assert min(counts["route-risk"], counts["team-risk"]) >= 30 and counts["uncertain-durations"] == 60
    assert sum(features_of(risky(1, number)) >= {"route-risk", "team-risk"} for number in range(60)) >= 15
    assert risky(1, 7).digest() == risky(1, 7).digest() != risky(2, 7).digest()


@pytest.mark.long
@pytest.mark.parametrize("part", range(12))
def test_everything_agrees_with_enumeration_where_durations_are_uncertain(part: int) -> None:
    found = list(benchmark.records(1, range(25 * part, 25 * part + 25), draw=risky))
    assert not [fault for record in found for fault in record.faults]


def test_a_disagreement_is_told_with_exit_1_and_problems_of_the_file_are_not_done_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    arguments = ["--instances", "1", "--first", str(few(1, 2)[0]), "--out", str(tmp_path / "found.jsonl")]
    one_solver = benchmark.examined
    monkeypatch.setattr(benchmark, "examined", lambda number, problem: one_solver(number, problem, ["highs"], heuristics=False))
    assert benchmark.main(arguments) == 0
    told = capsys.readouterr().out
    assert "| highs |" in told and "1 problems on which an exact solver agrees, 0 on which anything said was false" in told

    class Wrong(benchmark.RoutingTruth):
        def value(self, answer: object) -> None:
            return None

    monkeypatch.setattr(benchmark, "RoutingTruth", Wrong)
    assert benchmark.main(arguments) == 0
    assert benchmark.main(arguments[:-2]) == 1
    assert "the judge and enumeration differ" in capsys.readouterr().err


def test_values_and_bounds_are_compared_by_their_share() -> None:
    this = benchmark._Examined(0, drawn(1, few(1, 2)[0]))
    this.truth.best = this.truth.lenient = (Fraction(100),)
    this.record.optimum, this.truth.mixed = [100.0], False
    assert this.equal([100.0 + 9e-5]) and not this.equal([100.0 + 2e-4])
    better = 99.0 if this.problem.sense == "min" else 101.0
    assert this.beats([better]) and not this.beats([200.0 - better]) and not this.beats([100.0])
