from dataclasses import replace

import pytest

from waybound.reports.benchmarks import protections as benchmark

SMALL = {"bottleneck": ("max-min", lambda k: benchmark.GROUPS["bottleneck"][1](k))}


def test_all_options_reach_the_same_optima():
    lines = list(benchmark.rows(1, 60.0, SMALL))
    assert len(lines) == len(benchmark.RUNS)
    assert all("1/1" in line for line in lines)


def test_a_wrong_value_is_noticed(monkeypatch):
    honest = benchmark.run

    def lying(program, solver, own, limit):
        seconds, result = honest(program, solver, own, limit)
        return seconds, replace(result, objective=result.objective + (1.0 if "presolve" in own else 0.0))

    monkeypatch.setattr(benchmark, "run", lying)
    with pytest.raises(AssertionError, match="no presolve"):
        list(benchmark.rows(1, 60.0, SMALL))


def test_every_group_can_be_written_in_its_form():
    for form, make in benchmark.GROUPS.values():
        assert make(0).compile(form).program.is_integer
