"""Bins of an orchard in files."""

from __future__ import annotations

import json

import numpy as np
import pytest
from orchard_cases import random_jobs

import waybound as wb
from waybound.instances.errors import InputError
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance


def test_files_give_back_what_was_written(tmp_path):
    rng = np.random.default_rng(1)
    for k in range(5):
        jobs = random_jobs(rng)
        write_instance(jobs, tmp_path / f"{k}.json")
        again = read_instance(tmp_path / f"{k}.json")
        assert again.digest() == jobs.digest()
        assert again.name == jobs.name
        assert wb.read(tmp_path / f"{k}.json").problem == "orchard-day"


@pytest.mark.parametrize(
    ("where", "value", "message"),
    [
        (("orchard", "columns"), 2, "columns"), (("robots", "row"), [9, 0, 0], "lies outside"), (("bins", "work"), [1], "work"),
        (("problem",), "tsp", "none of bins in an orchard"), (("bins", "standing"), [1] * 5, "standing"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_file_is_told(tmp_path, where, value, message):
    path = tmp_path / "jobs.json"
    write_instance(random_jobs(np.random.default_rng(1)), path)
    data = json.loads(path.read_text())
    part = data
    for key in where[:-1]:
        part = part[key]
    part[where[-1]] = value
    path.write_text(json.dumps(data))
    with pytest.raises(InputError, match=message):
        read_instance(path)
