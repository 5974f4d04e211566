"""Seventeen corners of a city, and what the tutorials of OR-Tools and PyVRP ask of them.

Source of all data and of the published objectives: the routing guide of OR-Tools (developers.google.com/optimization/routing, samples in
``ortools/constraint_solver/samples``) and PyVRP's tutorial (``examples/quick_tutorial.ipynb``), which asks more of the same corners. The
guide's matrix is that of distances along streets between these coordinates.
"""

import numpy as np
import pandas as pd

# fmt: off
CORNERS = [(456, 320), (228, 0), (912, 0), (0, 80), (114, 80), (570, 160), (798, 160), (342, 240), (684, 240), (570, 400), (912, 400),
           (114, 480), (228, 480), (342, 560), (684, 560), (0, 640), (798, 640)]
MINUTES = np.array([[int(v) for v in row.split()] for row in """
0 6 9 8 7 3 6 2 3 2 6 6 4 4 5 9 7
6 0 8 3 2 6 8 4 8 8 13 7 5 8 12 10 14
9 8 0 11 10 6 3 9 5 8 4 15 14 13 9 18 9
8 3 11 0 1 7 10 6 10 10 14 6 7 9 14 6 16
7 2 10 1 0 6 9 4 8 9 13 4 6 8 12 8 14
3 6 6 7 6 0 2 3 2 2 7 9 7 7 6 12 8
6 8 3 10 9 2 0 6 2 5 4 12 10 10 6 15 5
2 4 9 6 4 3 6 0 4 4 8 5 4 3 7 8 10
3 8 5 10 8 2 2 4 0 3 4 9 8 7 3 13 6
2 8 8 10 9 2 5 4 3 0 4 6 5 4 3 9 5
6 13 4 14 13 7 4 8 4 4 0 10 9 8 4 13 4
6 7 15 6 4 9 12 5 9 6 10 0 1 3 7 3 10
4 5 14 7 6 7 10 4 8 5 9 1 0 2 6 4 8
4 8 13 9 8 7 10 3 7 4 8 3 2 0 4 5 6
5 12 9 14 12 6 6 7 3 3 4 7 6 4 0 9 2
9 10 18 6 8 12 15 8 13 9 13 3 4 5 9 0 9
7 14 9 16 14 8 5 10 6 5 4 10 8 6 2 9 0
""".strip().splitlines()])
DEMAND = [0, 1, 1, 2, 4, 2, 4, 8, 8, 1, 2, 1, 2, 4, 4, 8, 8]
HEAVY = [0, 1, 1, 3, 6, 3, 6, 8, 8, 1, 2, 1, 2, 6, 6, 8, 8]
READY = [0, 7, 10, 16, 10, 0, 5, 0, 5, 0, 10, 10, 0, 5, 7, 10, 11]
DUE = [5, 12, 15, 18, 13, 5, 10, 4, 10, 3, 16, 15, 5, 10, 8, 15, 15]
SHIPMENTS = [(1, 6), (2, 10), (4, 3), (5, 9), (7, 8), (15, 11), (13, 12), (16, 14)]
PRIZES = [0, 0, 334, 413, 295, 471, 399, 484, 369, 410, 471, 382, 347, 380, 409, 302, 411]
DELIVERY = [0, 0, 1, 2, 0, 6, 4, 11, 3, 0, 6, 1, 0, 6, 3, 4, 0]
PICKUP = [0, 0, 4, 0, 5, 3, 7, 0, 0, 5, 4, 4, 3, 0, 2, 3, 6]
GROUPS = [(2, 3, 4, 5), (6, 7, 8, 9), (10, 11, 12, 13), (14, 15, 16)]
ZONE = ((500, 125), (850, 275))
# fmt: on

CITY = pd.DataFrame({"id": range(17)})
STREETS = np.abs(np.array(CORNERS)[:, None] - np.array(CORNERS)[None]).sum(axis=2)
"""Distances in metres."""
