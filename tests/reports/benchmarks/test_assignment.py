import pytest

from waybound.reports.benchmarks import assignment


def test_both_find_the_same_optimum_and_the_auction_proves_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert assignment.main(["--sizes", "40", "--sparse", "200", "--repeats", "1"]) == 0
    told = capsys.readouterr().out
    for word in ("whole", "uniform", "euclidean", "sparse", "proved"):
        assert word in told
