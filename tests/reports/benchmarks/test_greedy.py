import importlib.util

import pytest

from waybound.reports.benchmarks import greedy as benchmark


def test_all_contestants_pick_alike() -> None:
    for what in benchmark.TARGETS:
        found = benchmark.measure(benchmark.generate(what, 200, 10, seed=3), 1)
        assert len({tuple(chosen) for _, chosen, _ in found.values()}) == 1
        assert found["lazy-greedy"][2]["evaluations"] < found["lazy-greedy"][2]["plain_evaluations"]


def test_the_report_says_whether_the_peer_was_there(monkeypatch: pytest.MonkeyPatch) -> None:
    text, _ = benchmark.report(100, 5, seed=1, repeats=1)
    assert ("submodlib LazyGreedy" in text) == (importlib.util.find_spec("submodlib") is not None)
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *rest: None if name == "submodlib" else find(name, *rest))
    text, _ = benchmark.report(100, 5, seed=1, repeats=1)
    assert "submodlib-py is not installed, so there is no comparison" in text


def test_the_data_follow_from_the_seed() -> None:
    digests = [benchmark.generate("coverage", 50, 3, seed).digest() for seed in (1, 1, 2)]
    assert digests[0] == digests[1] != digests[2]
