"""The weak linearisation: what it writes, product by product."""

from __future__ import annotations

from pathlib import Path

from program_text import expected, written

ROBOTS = """
    # problem: winner-takes-all
    robot,action,target,weight
    r,left,t,5
    r,right,t,2
    r,right,u,3
    s,stay,t,2
    s,stay,u,1
"""


def test_weak_linearisation_from_text_to_text(tmp_path: Path) -> None:
    """Both actions of r that see t draw on the one credit y[r,t], each in full: that is what makes the relaxation weak."""
    assert written(ROBOTS, "weak-linearisation", tmp_path) == expected(
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
