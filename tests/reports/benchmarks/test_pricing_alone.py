import sys
from pathlib import Path

import pytest

from waybound.reports.benchmarks.pricing_alone import main

SOLOMON = """SMALL

VEHICLE
NUMBER     CAPACITY
  4          50

CUSTOMER
CUST NO.  XCOORD.  YCOORD.  DEMAND  READY TIME  DUE DATE  SERVICE TIME

  0  40  50   0    0  240   0
  1  45  68  10   20  120  10
  2  45  70  30   30  190  10
  3  42  66  10    0  200  10
  4  42  53  20    0  210  10
  5  22  75  30   40  180  10
"""

PLAYED = """
__version__ = "played"


class PWSolver:
    def __getattr__(self, name):
        return lambda *given: self.told.setdefault(name, []).append(given)

    def createProblem(self):
        self.told = {}

    def addResource(self, kind):
        return {"TW": 0, "CAP": 1}[kind]

    def solve(self):
        cost, clock = {g[:2]: g[2] for g in self.told["setArcCost"]}, {g[1:3]: g[3] for g in self.told["setResArcConsumption"]}
        window, load = {g[1]: g[2:] for g in self.told["setResNodeBound"]}, {g[1]: g[2] for g in self.told["setResNodeConsumption"]}
        most, end = self.told["setResBounds"][0][2], self.told["setDestination"][0][0]

        def best(node, time, loaded, seen):
            if node == end:
                return 0
            totals = [10**9]
            for (i, j), price in cost.items():
                arrival = max(time + clock[i, j], window[j][0]) if i == node else 10**9
                if j not in seen and arrival <= window[j][1] and loaded + load[j] <= most:
                    totals.append(price + best(j, arrival, loaded + load[j], seen | {j}))
            return min(totals)

        self.best = best(0, 0, 0, {0}) + ADDED

    def getSolutionStatus(self, at):
        return 2

    def getSolutionObjective(self, at):
        return self.best
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "vrptw-solomon").mkdir()
    (tmp_path / "vrptw-solomon" / "SMALL.txt").write_text(SOLOMON)
    return tmp_path


@pytest.mark.parametrize("added", [0, 1])
def test_least_costs_are_compared(added: int, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "routepricer.py").write_text(PLAYED.replace("ADDED", str(added)))
    monkeypatch.setenv("PYTHONPATH", str(folder))
    arguments = ["--folder", str(folder), "--file", "SMALL", "--prices", "3", "--repeats", "1", "--peer", sys.executable]
    assert main(arguments) == added
    said = capsys.readouterr().out
    assert said.count("| SMALL |") == 3 and said.count("DIFFERS") == 3 * added and said.endswith("RoutePricer played\n")


def test_ours_is_measured_alone(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--folder", str(folder), "--file", "SMALL", "--prices", "2"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "| file | search | least cost | CPU s |"
