import pytest

from waybound.reports.benchmarks import routing_roots


@pytest.mark.parametrize(("name", "partition", "best"), [("SQUARE-4, 2, 14", 20.0, 20.0), ("GAP-5, 2, 26", 30.6667, 36.0)])
def test_roots_are_below_the_optimum_and_set_partitioning_is_the_highest(name: str, partition: float, best: float) -> None:
    header, row = routing_roots.table([name])
    found = dict(zip(header[1:], map(float, row[1:]), strict=True))
    assert found["set-partitioning"] == pytest.approx(partition, abs=1e-3)
    assert found.pop("optimum") == best
    assert max(found.values()) == found["set-partitioning"]


def test_forms_that_cannot_take_a_problem_have_a_dash(capsys: pytest.CaptureFixture[str]) -> None:
    assert routing_roots.main(["--only", "SQUARE-4, 2, makespan"]) == 0
    row = capsys.readouterr().out.splitlines()[1].split(" | ")
    assert row[1] == "-" and row[-1] == "12 |"
