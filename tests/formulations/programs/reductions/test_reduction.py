import itertools

import numpy as np
import pytest
from hypothesis import given, strategies as st

from tests.programs import INF, program
from waybound.formulations.programs.exactness import Exactness
from waybound.formulations.programs.reductions.continuous_relaxation import CONTINUOUS_RELAXATION
from waybound.formulations.programs.reductions.finite_bounds import FINITE_BOUNDS
from waybound.formulations.programs.reductions.minimisation import MINIMISATION
from waybound.formulations.programs.reductions.one_sided_rows import ONE_SIDED_ROWS
from waybound.formulations.programs.reductions.reduction import Chain
from waybound.formulations.programs.reductions.sound_arrays import UNIQUE_ENTRIES
from waybound.formulations.programs.reductions.units import UNITS
from waybound.formulations.programs.reductions.whole_numbers import WHOLE_NUMBERS

ALL = (UNIQUE_ENTRIES, UNITS, MINIMISATION, ONE_SIDED_ROWS, FINITE_BOUNDS)


def random_program(rng: np.random.Generator):
    n, m, unit = int(rng.integers(2, 5)), int(rng.integers(1, 4)), float(np.exp2(rng.integers(-30, 31)))
    matrix = rng.integers(-3, 4, (m, n))
    high = matrix @ rng.integers(0, 3, n) + rng.integers(0, 3, m)
    low = np.where(rng.random(m) < 0.5, high - rng.integers(0, 9, m), -np.inf)
    return program(
        rng.integers(-9, 10, n) * unit, matrix, low, high, 0, rng.integers(1, 4, n), integer=range(n),
        sense=str(rng.choice(["min", "max"])), offset=float(rng.integers(-9, 10)) * unit,
    )  # fmt: skip


def points(p):
    grids = [range(int(lo), int(hi) + 1) for lo, hi in zip(p.lower, p.upper, strict=True)]
    return [np.array(x, dtype=float) for x in itertools.product(*grids)]


@given(st.integers(0, 10**6), st.booleans())
def test_points_and_values_come_back_through_all_of_them(seed: int, whole: bool) -> None:
    p = random_program(np.random.default_rng(seed))
    chain = Chain(p).then((*ALL, WHOLE_NUMBERS) if whole else ALL)
    assert chain.exactness is Exactness.EXACT
    for x in points(p):
        there = chain.encoded(x)
        assert np.array_equal(chain.vector(there), x)
        assert (chain.program.residual(there) <= 1e-9) == (p.residual(x) <= 1e-9) or whole  # counted values are within their bounds
        assert chain.value(chain.program.value(there)) == pytest.approx(p.value(x), rel=1e-12, abs=1e-12 * np.abs(p.cost).max(initial=0.0))


def test_flags_compose_and_links_tell_what_was_done() -> None:
    p = program([1, 2], [[1, 1]], 1, 3, 0, INF, integer=[0, 1], sense="max", offset=1)
    chain = Chain(p).then((MINIMISATION, CONTINUOUS_RELAXATION, ONE_SIDED_ROWS))
    assert [link.name for link in chain.links] == ["minimisation", "continuous-relaxation", "one-sided-rows"]
    assert chain.exactness is Exactness.RELAXATION
    assert chain.source is p
    assert chain.duals(np.array([2.0, 3.0])).tolist() == [-5.0]
    assert chain.bound(-7.0) == 8.0


def test_a_chain_without_steps_is_the_program_itself() -> None:
    p = program([1], [[1]], 1, INF, 0, 5)
    chain = Chain(p).then(ALL)
    assert chain.steps == ()
    assert chain.program is p
