"""The product form: what it writes, and that it has no relaxation."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_text import expected, written
from selection_problems import cover_30

from waybound.instances.errors import UsageError

ROBOTS = """
    # problem: winner-takes-all
    robot,action,target,weight
    r,left,t,5
    r,right,t,2
    r,right,u,3
    s,stay,t,2
    s,stay,u,1
"""


def test_product_from_text_to_text(tmp_path: Path) -> None:
    assert written(ROBOTS, "product", tmp_path) == expected(
        """
        product, exact
        max 5 x[left] y[r,t] + 2 x[right] y[r,t] + 3 x[right] y[r,u] + 2 x[stay] y[s,t] + x[stay] y[s,u]
        robot[r]: x[left] + x[right] <= 1
        robot[s]: x[stay] <= 1
        item[t]: y[r,t] + y[s,t] <= 1
        item[u]: y[r,u] + y[s,u] <= 1
        x[left], x[right], x[stay], y[r,t], y[r,u], y[s,t], y[s,u] binary
        """
    )


def test_the_product_form_has_no_linear_relaxation():
    with pytest.raises(UsageError, match="not linear"):
        cover_30(3).compile("product", relax=True)
