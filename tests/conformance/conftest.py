"""One suite for every backend: programs as arrays, and the conditions that answers must meet."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from programs import program

from waybound import Program, UnsupportedError
from waybound.solvers.backend import BACKENDS, Control, Engine, Options, RawResult
from waybound.solvers.backends.cvxpy import solvers_found
from waybound.solvers.program_backend import ProgramBackend

TOLERANCE = 1e-6
INF = math.inf


def _names(kind: type) -> list[str]:
    names = [n for n in BACKENDS if issubclass(BACKENDS[n], kind) and BACKENDS[n].installed()]
    through_cvxpy = [s for s in solvers_found() if s != "CLARABEL"]
    more = {"pulp": ["HiGHS"], "mathopt": ["highs", "gscip", "glop", "cp-sat", "pdlp"], "cvxpy": through_cvxpy}
    return [*names, *(f"{n}:{v}" for n in names for v in more.get(n, []) if kind is ProgramBackend)]


PROGRAM_BACKENDS = _names(ProgramBackend)
ENGINES = [n for n in _names(Engine) if BACKENDS[n].family == "routing"]


def _made(name: str) -> Any:
    base, _, variant = name.partition(":")
    kind: Any = BACKENDS[base]
    return kind(variant) if variant else kind()


FURTHER = ("mathopt", "cvxpy", "pulp", "cpsat", "outer-approximation")
"""Their limits are tried among the slow tests only, for they take seconds each; the fast suite tries those of HiGHS and SCIP."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of the limits of further solvers as slow."""
    for item in items:
        name = getattr(item, "callspec", None) and item.callspec.params.get("backend_name")
        if name and name.startswith(FURTHER) and item.path.name == "test_limits.py":
            item.add_marker(pytest.mark.slow)


@pytest.fixture(params=PROGRAM_BACKENDS)
def backend_name(request: pytest.FixtureRequest) -> str:
    """Each backend for programs, in turn."""
    return str(request.param)


@pytest.fixture
def solve_with(backend_name: str) -> Callable[..., RawResult]:
    """``solve_with(program, control=None, **options)``; skips programs of features that the backend does not declare."""

    def solve(program: Program, control: Control | None = None, **options: Any) -> RawResult:
        backend = _made(backend_name)
        if ProgramBackend.missing(backend, program):
            pytest.skip(f"{backend_name} takes no {program.kind}")
        try:
            result = backend.run(program, Options(**options), control or Control())
        except UnsupportedError as fault:  # tests of their own say which features a backend may refuse
            pytest.skip(str(fault))
        assert isinstance(result, RawResult)
        return result

    return solve


@pytest.fixture(params=ENGINES)
def engine_name(request: pytest.FixtureRequest) -> str:
    """Each engine for routing problems, in turn."""
    return str(request.param)


@pytest.fixture(scope="session")
def knapsack() -> Program:
    """Too hard to finish in seconds; first points are found at once. Thirty rows, 250 binaries, maximised."""
    rng = np.random.default_rng(0)
    m, n = 30, 250
    a = rng.integers(10, 1000, (m, n)).astype(float)
    return program(
        rng.integers(10, 1000, n).tolist(), a, -INF, np.floor(a.sum(axis=1) / 2), 0, 1, integer=range(n), sense="max", offset=5.0
    )


@pytest.fixture(scope="session")
def branching() -> Program:
    """Takes a few nodes: eight rows, 60 binaries, maximised."""
    rng = np.random.default_rng(0)
    a = rng.integers(10, 1000, (8, 60)).astype(float)
    return program(rng.integers(10, 1000, 60).tolist(), a, -INF, np.floor(a.sum(axis=1) / 2), 0, 1, integer=range(60), sense="max")


@pytest.fixture(scope="session")
def market_split() -> Program:
    """Cornuejols and Dawande's market split problem: six equations over 50 binaries, no point found in seconds."""
    rng = np.random.default_rng(0)
    m, n = 6, 50
    a = rng.integers(0, 100, (m, n)).astype(float)
    half = np.floor(a.sum(axis=1) / 2)
    return program([0.0] * n, a, half, half, 0, 1, integer=range(n))


def _check_kkt(program: Program, result: RawResult) -> None:
    x, y = result.answer, result.row_duals
    assert program.residual(x) <= TOLERANCE
    assert result.objective == pytest.approx(program.value(x), abs=1e-7)
    sign = 1.0 if program.sense == "min" else -1.0
    gradient = program.cost if program.quadratic is None else program.cost + program.quadratic @ x
    activity, y = program.matrix @ x, sign * y
    reduced = sign * gradient - program.matrix.T @ y
    for value, multiplier, low, high in ((activity, y, program.row_lower, program.row_upper), (x, reduced, program.lower, program.upper)):
        # A positive multiplier leans on the lower side, a negative one on the upper side.
        assert (np.minimum(np.maximum(multiplier, 0.0), value - low) <= TOLERANCE).all()
        assert (np.minimum(np.maximum(-multiplier, 0.0), high - value) <= TOLERANCE).all()


@pytest.fixture(scope="session")
def check_optimum() -> Callable[..., None]:
    """``check_optimum(program, result, value)``: feasible, of the known value, and KKT wherever the backend tells duals."""

    def check(program: Program, result: RawResult, value: float) -> None:
        assert (result.status, result.limit) == ("optimal", "none"), result
        assert program.residual(result.answer) <= TOLERANCE
        assert result.objective == pytest.approx(program.value(result.answer), abs=1e-7)
        assert result.objective == pytest.approx(value, abs=TOLERANCE)
        assert result.bound == pytest.approx(value, abs=TOLERANCE)
        if result.row_duals is not None:
            _check_kkt(program, result)

    return check
