"""Which solver and which form are taken where none is named, and what is said where none fits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from programs import program
from sata_cases import CASES

import waybound as wb
from waybound.formulations.forms import FORMS
from waybound.formulations.max_min.bottleneck_sata import BottleneckSATA
from waybound.formulations.programs.program import CONES, INTEGERS, LINEAR, QUADRATIC
from waybound.formulations.selection.winner_takes_all_sata import WinnerTakesAllSATA
from waybound.instances.errors import UnsupportedError
from waybound.solvers.backend import BACKENDS, ProgramBackend, takers, takes_features
from waybound.solving.listing import missing_features

S3 = CASES["S3"].graph


def test_the_features_that_a_form_declares_are_those_of_its_program() -> None:
    problems = [
        BottleneckSATA(S3), BottleneckSATA(S3, fractional=True), WinnerTakesAllSATA(S3),
        wb.MaxMinLP(np.eye(2), np.eye(2)), wb.MaxMinLP(np.eye(2), np.eye(2), sense="min"),
    ]  # fmt: skip
    for problem in problems:
        for form in problem.forms():
            assert FORMS[form].makes(problem) == problem.compile(form).program.features()


def test_a_linear_form_is_taken_where_none_is_named() -> None:
    solution = wb.solve(WinnerTakesAllSATA(S3), bound_time=0)
    assert (solution.solver, solution.form) == ("highs", "facility-location")


def test_the_form_decides_which_solver_is_taken() -> None:
    solution = wb.solve(WinnerTakesAllSATA(S3), form="product", bound_time=0)
    assert solution.solver in ("scip", "mathopt")
    assert solution.objective == 31.0


def test_a_relaxation_is_solved_as_a_linear_program() -> None:
    assert wb.solve(WinnerTakesAllSATA(S3), relax=True, bound_time=0).solver == "highs"
    assert wb.solve(BottleneckSATA(S3), "cvxpy:CLARABEL", relax=True, bound_time=0).bound == pytest.approx(10.0, abs=1e-6)


def test_a_compiled_program_finds_a_solver_of_its_kind() -> None:
    assert wb.solve(WinnerTakesAllSATA(S3).compile("product"), bound_time=0).solver in ("scip", "mathopt")
    miqp = program([0, 0], [[1, 1]], -math.inf, 2, 0, 1, integer=[0, 1], sense="max", quadratic=[[0, 1], [1, 0]])
    assert wb.solve(miqp, bound_time=0).objective == pytest.approx(1.0)


def test_a_solver_that_lacks_the_kind_is_listed_with_what_it_lacks() -> None:
    fractional = BottleneckSATA(S3, fractional=True)
    assert missing_features("cpsat", fractional) == (frozenset({"LP programs"}), ())
    assert missing_features("cpsat", BottleneckSATA(S3)) == (frozenset(), ("max-min",))
    forms = ("facility-location", "strong-linearisation", "weak-linearisation")
    assert missing_features("highs", WinnerTakesAllSATA(S3)) == (frozenset(), forms)
    assert missing_features("cpsat", WinnerTakesAllSATA(S3)) == (frozenset(), (*forms, "product"))


def test_a_solver_that_lacks_the_kind_refuses_and_names_others() -> None:
    with pytest.raises(UnsupportedError, match=r"cpsat cannot take this problem: it lacks LP programs; can take it: .*highs"):
        wb.solve(BottleneckSATA(S3, fractional=True), "cpsat")
    with pytest.raises(UnsupportedError, match=r"highs cannot take this problem: it lacks MIQP programs; can take it: .*cpsat"):
        wb.solve(WinnerTakesAllSATA(S3), "highs", form="product")


def test_takers_are_installed_and_take_what_they_say() -> None:
    for features in (LINEAR, INTEGERS, QUADRATIC, INTEGERS | QUADRATIC, *({cone} for cone in CONES), CONES, CONES | QUADRATIC):
        assert takers(frozenset(features))
        for name in takers(frozenset(features)):
            base, _, variant = name.partition(":")
            backend = BACKENDS[base](variant) if variant else BACKENDS[base]()
            assert isinstance(backend, ProgramBackend)
            assert takes_features(frozenset(features), backend.programs, backend.only_integers)
    assert "highs" not in takers(LINEAR, "highs")
    assert takers(CONES | INTEGERS) == []
