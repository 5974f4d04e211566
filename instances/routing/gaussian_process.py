"""A Gaussian process over the plane that learns from noisy measurements, each with a noise of its own."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..number_arrays import Floats


@dataclass(frozen=True)
class SquaredExponential:
    """The kernel ``deviation``^2 exp(-d^2 / (2 ``length``^2)) of points at a distance d, in units of the measured quantity and m."""

    deviation: float = 1.0
    length: float = 1.0

    def __post_init__(self) -> None:
        for name in ("deviation", "length"):
            value = getattr(self, name)
            if not 0.0 < value < np.inf:
                raise InputError(f"the {name} of a kernel must be positive and finite", "out-of-range", found=f"{value:g}")

    def __call__(self, a: Floats, b: Floats) -> Floats:
        """Covariances of points ``a`` and ``b``; shapes (m, 2) and (n, 2) give (m, n)."""
        from scipy.spatial.distance import cdist

        return np.asarray(self.deviation**2 * np.exp(-0.5 / self.length**2 * cdist(a, b, "sqeuclidean")))


@dataclass(frozen=True, eq=False)
class GaussianProcess:
    """Belief about a quantity at test points, from the measurements given so far. Begin with ``prior``.

    ``points`` are the test points, shape (points, 2), m; ``mean`` has the shape (points,), ``covariance`` (points, points).

    Source: Sung (2019), (5.2)-(5.5). A measurement adds rows to the Cholesky factor of K(X, X) + Q, so that nothing is factorised twice;
    docs/missions/hotspot-identification.md#belief.
    """

    kernel: SquaredExponential
    points: Floats
    mean: Floats
    covariance: Floats
    _places: Floats
    _factor: Floats
    _to_points: Floats
    _whitened: Floats

    @classmethod
    def prior(cls, kernel: SquaredExponential, points: Floats) -> "GaussianProcess":
        """The belief before the first measurement, with mean 0."""
        count, none = len(points), np.zeros(0)
        return cls(
            kernel, points, np.zeros(count), kernel(points, points), none.reshape(0, 2), none.reshape(0, 0), none.reshape(0, count), none
        )

    def given(self, places: Floats, values: ArrayLike, noise: ArrayLike) -> "GaussianProcess":
        """The belief after measuring ``values`` at ``places``, shape (n, 2), with variances ``noise``. Raises InputError for no noise."""
        from scipy.linalg import cholesky, solve_triangular

        q = np.broadcast_to(np.asarray(noise, dtype=np.float64), len(places))
        if not (q > 0.0).all() or not np.isfinite(q).all():
            raise InputError("the noise of a measurement must be positive and finite", "out-of-range", found=f"{q.min():g}")
        before = len(self._places)
        across = solve_triangular(self._factor, self.kernel(self._places, places), lower=True)
        corner = cholesky(self.kernel(places, places) + np.diag(q) - across.T @ across, lower=True)
        news = solve_triangular(corner, self.kernel(places, self.points) - across.T @ self._to_points, lower=True)
        surprise = solve_triangular(corner, np.asarray(values, dtype=np.float64) - across.T @ self._whitened, lower=True)
        factor = np.zeros((before + len(places),) * 2)
        factor[:before, :before], factor[before:, :before], factor[before:, before:] = self._factor, across.T, corner
        return GaussianProcess(
            self.kernel, self.points, self.mean + news.T @ surprise, self.covariance - news.T @ news, np.vstack([self._places, places]),
            factor, np.vstack([self._to_points, news]), np.concatenate([self._whitened, surprise]),
        )  # fmt: skip

    @property
    def variance(self) -> Floats:
        """Variances of the quantity at the test points."""
        return np.maximum(np.diagonal(self.covariance), 0.0)

    def variance_left(self, groups: NDArray[np.intp], noise: float) -> Floats:
        """Variances at test points once those of their group were measured, too: the future variance of Sung (2019), (5.7).

        ``groups`` of shape (groups, points a group) are numbers of test points, ``noise`` is the variance of each measurement.
        """
        now = self.covariance[groups[:, :, None], groups[:, None, :]]
        noisy = now + noise * np.eye(groups.shape[1])
        left = np.diagonal(now - now @ np.linalg.solve(noisy, now), axis1=1, axis2=2)
        return np.maximum(left, 0.0)
