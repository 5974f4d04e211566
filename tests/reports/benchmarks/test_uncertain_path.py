import numpy as np
import pytest

from waybound.reports.benchmarks import uncertain_path as benchmark


@pytest.mark.slow
def test_every_part_is_measured_and_judged(capsys):
    code = benchmark.main(["--comparisons", "20", "--samples", "2000", "--graphs", "2", "--walked", "1", "--draws", "1"])
    text = capsys.readouterr().out
    assert code in (0, 1)  # by the clock of a busy machine
    assert text.count("a second (best of 3") == 2
    assert text.count(": met") + text.count(": MISSED") == 3
    assert [text.count(f"  {name} ") for name in ("rags", "a-star", "greedy", "d-star-lite")] == [3] * 4


def test_sets_are_of_the_size_asked_for():
    rng = np.random.default_rng(1)
    assert [len(s.means) for s in benchmark.random_sets(rng, 20)] == [20, 20]
    assert all(1 <= len(s.means) <= 20 for _ in range(20) for s in benchmark.random_sets(rng, 0))
