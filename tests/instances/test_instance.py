import hashlib

import numpy as np
import pytest

from waybound.instances.bundled import RECIPES, bundled_path
from waybound.instances.instance import Instance, digest
from waybound.instances.reading import read_instance


def test_the_digest_is_that_of_little_endian_bytes() -> None:
    """Shape and kind, 1.0 and -2.5 as IEEE doubles, a mark after each part; then the word as Python writes it."""
    data = b"f(2,)" + bytes.fromhex("000000000000f03f00000000000004c0") + b"\0" + b"'a'\0"
    assert digest(np.array([1.0, -2.5]), "a") == "sha256:" + hashlib.sha256(data).hexdigest()


def test_the_order_of_bytes_and_of_memory_does_not_matter() -> None:
    a = np.arange(6, dtype=np.int64).reshape(2, 3)
    assert digest(a) == digest(a.astype(">i8")) == digest(np.asfortranarray(a)) == digest(np.repeat(a, 2, axis=1)[:, ::2])


@pytest.mark.parametrize(
    "other",
    [
        (np.array([1.0, 2.0]), np.array([3.0])), (np.array([1.0]), np.array([2.0, 3.0])), (np.array([[1.0, 2.0, 3.0]]),),
        (np.array([1, 2, 3]),), (np.array([1.0, 2.0, 4.0]),), (np.array([1.0, 2.0, 3.0]), None), (np.array([1.0, 2.0, -0.0 + 3.0]), 0),
    ],
)  # fmt: skip
def test_other_data_have_another_digest(other: tuple[object, ...]) -> None:
    assert digest(*other) != digest(np.array([1.0, 2.0, 3.0]))


@pytest.mark.parametrize("name", RECIPES)
def test_every_bundled_file_is_an_instance_with_what_all_have(name: str) -> None:
    made = read_instance(bundled_path(name))
    assert isinstance(made, Instance)
    assert made.problem in made.problems and made.name and made.format
    assert not isinstance(object(), Instance)
