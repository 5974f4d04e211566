"""Fixtures shared by all tests."""

import gc
import importlib
import os
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer.main
import typer.testing
from draws import draws
from hypothesis import settings

# A busy machine is no fault of the code under test. CI repeats its examples; everywhere else each run draws new ones.
settings.register_profile("waybound", deadline=None, max_examples=draws(100))
settings.register_profile("ci", deadline=None, max_examples=draws(100), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "waybound")

for name in ("SIGHUP", "SIGQUIT"):  # ignored under nohup or in the background of a script, and by every process that tests start there
    if hasattr(signal, name):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


typer.testing._get_command = cache(typer.main.get_command)  # a runner makes all commands anew each time it runs one


@pytest.fixture(scope="session")
def benchmarks() -> Path:
    """Folder of the real benchmark files (WAYBOUND_BENCHMARKS)."""
    folder = os.environ.get("WAYBOUND_BENCHMARKS")
    if not folder or not Path(folder).is_dir():
        pytest.skip("WAYBOUND_BENCHMARKS names no folder: real benchmark files are not tested here")
    return Path(folder)


@pytest.fixture
def without_trees() -> Iterator[None]:
    """Bounds are found without the methods that search: they take all their time, and prove what a test may want claimed."""
    from waybound.solvers.bounds import BOUNDS

    with ExitStack() as stack:
        for method in [m for m in BOUNDS.values() if m.aims]:
            stack.enter_context(BOUNDS.temporary(method.name, replace(method, missing=lambda problem: frozenset({"a test"}))))
        yield


@pytest.fixture
def registered() -> Iterator[Callable[..., Any]]:
    """``registered(REGISTRY, name, entry)``: an entry for one test, in place of the one that may have the name."""
    with ExitStack() as stack:
        yield lambda registry, name, entry: stack.enter_context(registry.temporary(name, entry))


@pytest.fixture
def own_modules() -> Iterator[Callable[[str], Any]]:
    """``own_modules(NAME)`` imports a module that registers solvers or problems, for one test alone, as campaigns with modules do."""
    from waybound.formulations.problem import PROBLEMS
    from waybound.solvers.backend import BACKENDS

    before, path = set(sys.modules), list(sys.path)
    with ExitStack() as stack:
        for registry in (BACKENDS, PROBLEMS):
            first = registry.names()[0]
            stack.enter_context(registry.temporary(first, registry[first]))  # which forgets what comes meanwhile
        yield importlib.import_module
    sys.path[:] = path
    for name in set(sys.modules) - before:
        if name.startswith("waybound.reports.benchmarks.") or name.endswith("_of_a_test"):
            del sys.modules[name]


ORDER = ("hostile", "cli", "conformance", "docs", "formulations", "instances", "reference", "outside", "solving", "solvers")
"""Folders in the order of their tests: of two workers one begins with the loops that are compiled, the other where few are needed."""


def pytest_collection() -> None:
    """Little of what collecting makes is garbage: the collector would look through all of it time and again."""
    gc.disable()


def pytest_collection_finish() -> None:
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Of hostile tests those of all loops come first; of the cases of a test with a ``share`` the others are slow."""
    root = Path(__file__).parent
    seen: Counter[str] = Counter()
    for item in items:
        share = item.get_closest_marker("share")
        if share is not None and not any(item.get_closest_marker(name) for name in ("long", "hostile")):
            test = item.nodeid.partition("[")[0]
            if seen[test] % share.args[0]:
                item.add_marker(pytest.mark.slow)
            seen[test] += 1

    def place(item: pytest.Item) -> tuple[int, bool]:
        folder = item.path.relative_to(root).parts[0]
        return ORDER.index(folder) if folder in ORDER else len(ORDER), item.path.name != "test_kernels_stop.py"

    items.sort(key=place)


@pytest.fixture(autouse=True, scope="module")
def _settled_heap() -> None:
    """What is there when a module begins is not looked at by the garbage collector again: late in a run that takes seconds each time."""
    gc.collect()
    gc.freeze()
