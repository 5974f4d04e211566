import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from programs import sane

from waybound import InputError
from waybound.formulations.programs.soundness import refuse_numbers


@pytest.mark.parametrize(
    ("parts", "word"),
    [
        ({"lower": (0.0, math.inf), "upper": (1.0, math.inf)}, r"lower bound of variable x\[1\]"),
        ({"upper": (-math.inf, 1.0)}, r"upper bound of variable x\[0\]"),
        ({"side": (math.inf, math.inf)}, "left side of row need"), ({"side": (-math.inf, -math.inf)}, "right side of row need"),
        ({"data": (1.0, math.nan)}, "coefficient"), ({"indices": (0, 2)}, "column that does not exist"),
    ],
)  # fmt: skip
def test_numbers_that_mean_nothing_are_refused_by_name(parts, word: str) -> None:
    with pytest.raises(InputError, match=word):
        refuse_numbers(sane(**parts))


def test_a_sound_program_is_let_pass() -> None:
    refuse_numbers(sane())


def test_a_quadratic_part_of_which_solvers_would_read_different_halves_is_refused() -> None:
    halves = replace(sane(), quadratic=sp.csr_matrix(np.array([[0.0, 3.0], [0.0, 0.0]])))
    with pytest.raises(InputError, match=r"not symmetric: x\[0\] times x\[1\]"):
        refuse_numbers(halves)
    refuse_numbers(replace(sane(), quadratic=sp.csr_matrix(np.array([[0.0, 3.0], [3.0 + 1e-12, 0.0]]))))
