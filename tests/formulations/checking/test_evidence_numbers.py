import numpy as np
import pytest
from coded import coded

from waybound.formulations.checking.evidence_numbers import number, numbers
from waybound.instances.errors import InputError


def test_lists_of_numbers_are_read_as_they_are():
    assert numbers({"a": [1, 2.5, -3]}, "a", 3).tolist() == [1.0, 2.5, -3.0]
    assert numbers({"a": []}, "a", 0).shape == (0,)


def test_arrays_are_no_json():
    with pytest.raises(InputError, check=coded("missing")):
        numbers({"a": np.ones(3)}, "a", 3)


def test_a_default_stands_in_for_a_missing_number_only():
    assert number({}, "x", 2.0) == 2.0
    with pytest.raises(InputError):
        number({"x": None}, "x", 2.0)
    with pytest.raises(InputError):
        number({}, "x")
