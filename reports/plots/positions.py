"""Positions in the plane whose distances come close to given ones."""

import numpy as np

from ...instances.errors import UsageError
from ...instances.number_arrays import Floats

SCALED_SITES = 3000
"""Largest number of sites that are placed by scaling their distances (cubic time, square memory)."""


def scaled_positions(distances: Floats) -> Floats:
    """Positions in the plane whose distances come close to ``distances``, shape (sites, 2): classical scaling."""
    n = len(distances)
    if n > SCALED_SITES:
        raise UsageError(f"{n} sites without coordinates are too many to be placed on a map; at most {SCALED_SITES} are", "too-large")
    if n == 1:
        return np.zeros((1, 2))
    from scipy.linalg import eigh

    squares = ((distances + distances.T) / 2.0) ** 2
    centred = -0.5 * (squares - squares.mean(axis=0) - squares.mean(axis=1)[:, None] + squares.mean())
    values, vectors = eigh(centred, subset_by_index=[n - 2, n - 1])
    placed = vectors[:, ::-1] * np.sqrt(np.maximum(values[::-1], 0.0))
    signs = np.sign(placed[np.abs(placed).argmax(axis=0), [0, 1]])  # eigenvectors have no sign of their own
    return np.asarray(placed * np.where(signs == 0, 1.0, signs))
