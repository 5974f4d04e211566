import sys

import pytest

from tests.programs import program
from waybound import MissingPackageError, Program, UsageError
from waybound.solvers.backend import Control, Options
from waybound.solvers.backends.pulp import PuLP

SMALL = program([1], [[1]], 1, 2)
TRIVIAL = program([1], [[1]], 1, 2, 3, 2)


@pytest.mark.parametrize("variant", ["", "CBC", "cbc", "PULP_CBC_CMD"])
def test_cbc_goes_by_several_names(variant: str) -> None:
    assert PuLP(variant).is_cbc


@pytest.mark.parametrize("given", [SMALL, TRIVIAL])
def test_a_solver_that_pulp_does_not_know_is_refused_with_those_it_knows(given: Program) -> None:
    with pytest.raises(UsageError, match="HiGHS"):
        PuLP("NoSuchSolver").run(given, Options(), Control())


@pytest.mark.parametrize("given", [SMALL, TRIVIAL])
def test_a_solver_that_is_not_there_is_reported_as_missing(given: Program) -> None:
    import pulp

    absent = next(n for n in ("MOSEK", "XPRESS", "COPT") if n not in pulp.listSolvers(onlyAvailable=True))
    with pytest.raises(MissingPackageError, match=absent):
        PuLP(absent).run(given, Options(), Control())


def test_discovery_imports_nothing() -> None:
    import subprocess

    code = """
import sys
from waybound.solvers.backend import BACKENDS
[BACKENDS[n].installed() for n in BACKENDS]
print([m for m in ("pulp", "highspy", "ortools", "pyvrp") if m in sys.modules])
"""
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"
