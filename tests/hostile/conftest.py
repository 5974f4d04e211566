"""Attempts to make the toolkit say something false, lose an answer or hang: a share in the fast suite, all by `make test-hostile`.

A test asks ``share`` how many cases it shall run, draws them from ``numpy.random.default_rng``, and reports to ``tally`` what it did;
the counts are printed at the end of the run.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

import pytest

from waybound.formulations.kernels import kernel_modules, kernels

FULL = os.environ.get("WAYBOUND_HOSTILE") == "1"
"""Whether the full counts are run."""


@pytest.fixture(scope="session")
def share() -> Callable[[int, int], int]:
    """``share(few, all)``: the number of cases to run here."""
    return lambda few, full: full if FULL else few


@pytest.fixture(scope="session", autouse=FULL)
def compiled() -> Callable[[Iterable[str]], None]:
    """``compiled(modules)`` compiles the loops of modules. The full counts begin with all of them: they are about searching."""

    def compile_all(modules: Iterable[str]) -> None:
        for kernel in (kernel for module in modules for kernel in kernels(module)):
            if not kernel.kept():
                kernel.make()

    if FULL:
        compile_all(kernel_modules())
    return compile_all


@pytest.fixture
def tally(request: pytest.FixtureRequest) -> Any:
    """A Counter whose entries are printed, summed over all tests, at the end of the run: ``tally["mutated files"] += 1``."""
    counts: Counter[str] = Counter()
    yield counts
    request.node.user_properties.append(("tally", dict(counts)))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Print what was counted, whichever worker counted it."""
    total: Counter[str] = Counter()
    for reports in terminalreporter.stats.values():
        for report in reports:
            if getattr(report, "when", "") == "teardown":
                for name, value in getattr(report, "user_properties", ()):
                    if name == "tally":
                        total.update(value)
    if total:
        terminalreporter.section("hostile tests")
        for name, count in sorted(total.items()):
            terminalreporter.write_line(f"{count:>10,}  {name}")
