from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from programs import program

from waybound.formulations.programs.cones import Cones
from waybound.formulations.programs.program import CONES, INTEGERS, LINEAR, QUADRATIC, Program, described


def cone(kind: str) -> Cones:
    a = sp.csr_matrix(np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]))
    return Cones(kind, kind, 3, a.indptr, a.indices, a.data, np.zeros(3))


def plain(**changes: object) -> Program:
    return program([1, 1], [[1, 1]], 1, 9, **changes)  # type: ignore[arg-type]


BALL, RISE = cone("second-order"), cone("exponential")
SQUARES = [[2, 0], [0, 2]]


@pytest.mark.parametrize(
    ("made", "features", "words"),
    [
        (plain(), LINEAR, "LP"),
        (plain(integer=[1]), INTEGERS, "MILP"),
        (plain(quadratic=SQUARES), QUADRATIC, "QP"),
        (plain(quadratic=SQUARES, integer=[0]), INTEGERS | QUADRATIC, "MIQP"),
        (replace(plain(), cones=(BALL,)), {"second-order-cones"}, "cone LP"),
        (replace(plain(), cones=(RISE,)), {"exponential-cones"}, "cone LP"),
        (replace(plain(), cones=(BALL, RISE)), CONES, "cone LP"),
        (replace(plain(quadratic=SQUARES), cones=(RISE, RISE)), {"exponential-cones", "quadratic-objective"}, "cone QP"),
        (replace(plain(integer=[0]), cones=(BALL,)), {"second-order-cones", "integers"}, "cone MILP"),
    ],
)
def test_features_and_words(made: Program, features: frozenset[str], words: str) -> None:
    assert made.features() == features
    assert described(made.features()) == made.kind == words
    assert repr(made).startswith(f"<Program test: {words}, 2 variables, 1 rows")


def test_a_block_of_no_variables_has_no_integers() -> None:
    p = plain()
    none = replace(p.variables[0], lower=np.zeros(0), upper=np.zeros(0), cost=np.zeros(0), integer=True)
    assert replace(p, variables=(*p.variables, none)).features() == LINEAR
