"""The linearisations and the product form: what they write, row by row."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_text import expected, written
from sata_cases import TWO_ROBOTS
from selection_problems import cover_30

from waybound.instances.errors import UsageError


def test_strong_linearisation_from_text_to_text(tmp_path: Path) -> None:
    """All three actions that see t share one row of it."""
    assert written(TWO_ROBOTS, "strong-linearisation", tmp_path) == expected(
        """
        strong-linearisation, exact
        max 5 z[left,t] + 2 z[right,t] + 3 z[right,u] + 2 z[stay,t] + z[stay,u]
        robot[r]: x[left] + x[right] <= 1
        robot[s]: x[stay] <= 1
        item[t]: z[left,t] + z[right,t] + z[stay,t] <= 1
        item[u]: z[right,u] + z[stay,u] <= 1
        link[left,t]: - x[left] + z[left,t] <= 0
        link[right,t]: - x[right] + z[right,t] <= 0
        link[right,u]: - x[right] + z[right,u] <= 0
        link[stay,t]: - x[stay] + z[stay,t] <= 0
        link[stay,u]: - x[stay] + z[stay,u] <= 0
        x[left], x[right], x[stay] binary
        0 <= z[left,t], z[right,t], z[right,u], z[stay,t], z[stay,u] <= 1
        """
    )


def test_weak_linearisation_from_text_to_text(tmp_path: Path) -> None:
    """Both actions of r that see t draw on the one credit y[r,t], each in full: that is what makes the relaxation weak."""
    assert written(TWO_ROBOTS, "weak-linearisation", tmp_path) == expected(
        """
        weak-linearisation, exact
        max 5 z[left,t] + 2 z[right,t] + 3 z[right,u] + 2 z[stay,t] + z[stay,u]
        robot[r]: x[left] + x[right] <= 1
        robot[s]: x[stay] <= 1
        link[left,t]: - x[left] + z[left,t] <= 0
        link[right,t]: - x[right] + z[right,t] <= 0
        link[right,u]: - x[right] + z[right,u] <= 0
        link[stay,t]: - x[stay] + z[stay,t] <= 0
        link[stay,u]: - x[stay] + z[stay,u] <= 0
        credit[left,t]: - y[r,t] + z[left,t] <= 0
        credit[right,t]: - y[r,t] + z[right,t] <= 0
        credit[right,u]: - y[r,u] + z[right,u] <= 0
        credit[stay,t]: - y[s,t] + z[stay,t] <= 0
        credit[stay,u]: - y[s,u] + z[stay,u] <= 0
        item[t]: y[r,t] + y[s,t] <= 1
        item[u]: y[r,u] + y[s,u] <= 1
        x[left], x[right], x[stay] binary
        0 <= y[r,t], y[r,u], y[s,t], y[s,u], z[left,t], z[right,t], z[right,u], z[stay,t], z[stay,u] <= 1
        """
    )


def test_product_from_text_to_text(tmp_path: Path) -> None:
    assert written(TWO_ROBOTS, "product", tmp_path) == expected(
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
