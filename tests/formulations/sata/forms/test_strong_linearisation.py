"""The strong linearisation: what it writes, link by link."""

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


def test_strong_linearisation_from_text_to_text(tmp_path: Path) -> None:
    """All three actions that see t share one row of it."""
    assert written(ROBOTS, "strong-linearisation", tmp_path) == expected(
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
