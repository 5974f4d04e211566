import numpy as np
import pytest
from risk_problems import problem

from waybound.formulations.risk.forms._blocks import Blocks, dense_rows, evidence_of, prices


def test_convex_terms_have_the_value_of_the_problem() -> None:
    p = problem(
        sense="min", cost__constant=2,
        cost__terms=[
            {"kind": "absolute", "weight": 2, "decisions": [[1, -1]], "constant": [1]},
            {"kind": "norm", "weight": 3, "decisions": [[1, 0], [0, 1]], "constant": [0, 1]},
            {"kind": "square", "weight": 0.5, "decisions": [[2, 1]], "constant": [-1]},
        ],
    )  # fmt: skip
    x = np.array([0.7, 2.0])
    program = Blocks(p).program("blocks")
    whole = np.concatenate([x, [abs(0.7 - 2.0 + 1.0)], [np.hypot(0.7, 3.0)]])
    assert program.value(whole) == pytest.approx(p.value(x)[0])
    assert program.residual(whole) <= 1e-12
    assert [c.kind for c in program.cones] == ["second-order"]
    assert program.residual(whole - np.array([0, 0, 0, 0.1])) == pytest.approx(0.1)


def test_a_row_of_a_matrix_keeps_its_name() -> None:
    block = dense_rows("chance", np.array([[0.0, 2.0], [1.0, 0.0]]), -np.inf, 1.0, keys=(np.arange(2),), labels=(("a", "b"),))
    assert (block.label(1), block.indices.tolist(), block.data.tolist()) == ("chance[b]", [1, 0], [2.0, 1.0])


def test_prices_have_the_signs_of_a_minimisation() -> None:
    p = problem()
    blocks = Blocks(p)
    blocks.rows.append(dense_rows("chance", p.chance, -np.inf, p.limits))
    dual = prices(p, blocks.program("it"), np.zeros(2), np.array([2.0, 0.5, 0.0]))  # a reward grows with its right sides
    assert dual["rows"].tolist() == [-2.0] and dual["chance"].tolist() == [0.5, 0.0]
    assert evidence_of(dual, 1.0, "it").data["chance"] == {"at": [0], "values": [0.5]}
