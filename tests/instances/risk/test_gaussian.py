import numpy as np
import pytest
from coded import coded
from file_cases import check_refused, refused

from waybound.instances.errors import InputError
from waybound.instances.risk.gaussian import Dynamics, Quantities, check_covariance


def oscillator(steps: int) -> Dynamics:
    a, b = np.array([[0.9, 0.3], [-0.2, 0.8]]), np.array([[0.1], [1.0]])
    noise, start = np.array([[0.04, 0.01], [0.01, 0.02]]), np.array([[0.1, 0.0], [0.0, 0.05]])
    return Dynamics(a, b, noise, np.array([1.0, -1.0]), start, steps, ("p", "v"), ("u",))


def test_states_have_the_mean_and_covariance_of_a_simulation() -> None:
    d, rng, many = oscillator(4), np.random.default_rng(1), 200_000
    made, u = d.quantities(), np.array([0.5, -1.0, 0.2, 0.7])
    state = d.start + rng.standard_normal((many, 2)) @ np.linalg.cholesky(d.start_covariance).T
    played = []
    for t in range(4):
        state = state @ d.state.T + d.input[:, 0] * u[t] + rng.standard_normal((many, 2)) @ np.linalg.cholesky(d.noise).T
        played.append(state)
    every = np.concatenate(played, axis=1)
    assert made.map @ u + made.offset == pytest.approx(every.mean(axis=0), abs=5e-3)
    assert made.covariance == pytest.approx(np.cov(every.T), abs=5e-3)
    assert made.names[:3] == ("p@1", "v@1", "p@2")
    assert d.decision_names() == ("u@1", "u@2", "u@3", "u@4")


@pytest.mark.parametrize(
    ("matrix", "said"),
    [
        ([[1.0, 2.0], [2.0, 1.0]], "not positive semidefinite; found the least eigenvalue -1"),
        ([[1.0, 0.1], [0.2, 1.0]], "not symmetric; found entries of rows 1 and 2 that differ by 0.1"),
        ([[1.0, 0.0], [0.0, -0.3]], "negative variance; expected 0 or more; found -0.3 in row 2"),
        ([[np.nan]], "must be finite"),
    ],
)
def test_a_matrix_that_is_no_covariance_is_refused(matrix: list[list[float]], said: str) -> None:
    assert said in refused(check_covariance, "it", matrix)


def test_rounding_and_singular_covariances_pass() -> None:
    check_covariance("it", [[1.0, 1.0 + 1e-12], [1.0, 1.0]])
    check_covariance("it", np.zeros((2, 2)))


def test_shapes_are_checked() -> None:
    check_refused(InputError, "one row each quantity", Quantities, np.eye(2), np.zeros(3), np.eye(2), ("a", "b"))
    check_refused(InputError, "covariance has the wrong shape", Quantities, np.eye(2), np.zeros(2), np.eye(3), ("a", "b"))
    with pytest.raises(InputError, match="input has the wrong shape"):
        Dynamics(np.eye(2), np.zeros((1, 1)), np.eye(2), np.zeros(2), np.eye(2), 3, ("p", "v"), ("u",))
    with pytest.raises(InputError, check=coded("out-of-range")):
        Dynamics(np.diag([1e200, 1.0]), np.ones((2, 1)), np.eye(2), np.zeros(2), np.eye(2), 3, ("p", "v"), ("u",)).quantities()
    with pytest.raises(InputError, check=coded("out-of-range")):
        oscillator(0)


@pytest.mark.parametrize(
    ("covariance", "said"),
    [([[1.0, 0.0], [0.0, -1.0]], "negative variance; expected 0 or more; found -1 of b"), ([[1.0, 0.5], [0.0, 1.0]], "entries of a and b")],
)
def test_quantities_that_are_no_covariance_are_named(covariance: list[list[float]], said: str) -> None:
    with pytest.raises(InputError, match=said):
        Quantities(np.zeros((2, 1)), np.zeros(2), np.array(covariance), ("a", "b"))
