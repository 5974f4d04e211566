import numpy as np

from waybound.instances.generating import generate


def test_robots_at_the_repository_alone_have_something_to_bring() -> None:
    made = generate("joint-assignment", robots=5, home=2, bins=4, requests=3, seed=2)
    assert np.isfinite(made.to_request).all(axis=1).tolist() == [True, True, False, False, False]
    assert (made.to_bin[0] == made.to_bin[1]).all(), "both stand at the repository"
    assert made.digest() == generate("joint-assignment", robots=5, home=2, bins=4, requests=3, seed=2).digest()
    ways = made.to_request[0][:, None] + made.between
    assert (ways >= made.to_bin[0]).all(), "no detour is shorter"
    assert generate("joint-assignment", requests=0, seed=1).num_requests == 0
