"""Small files of several formats, whole and valid."""

from typing import Any

from file_cases import tsplib

OP = tsplib(
    "NAME : three", "TYPE : OP", "DIMENSION : 3", "TSPSOL : 12", "COST_LIMIT : 9", "EDGE_WEIGHT_TYPE : EUC_2D",
    NODE_COORD_SECTION="1 0 0|2 3 0|3 0 4", NODE_SCORE_SECTION="1 1|2 7|3 5", DEPOT_SECTION="2|-1",
) + "EOF\n"  # fmt: skip
VRPSPD = tsplib(
    "NAME : both", "TYPE : MVRPB", "DIMENSION : 3", "VEHICLES : 2", "CAPACITY : 10", "EDGE_WEIGHT_TYPE : EXACT_2D",
    NODE_COORD_SECTION="1 0 0|2 1 1|3 0 4", PICKUP_AND_DELIVERY_SECTION="1 0 0 10000000 0 0 0|2 0 0 10000000 0 3 7|3 0 0 10000000 5 2 8",
    DEPOT_SECTION="1|-1",
) + "EOF\n"  # fmt: skip
MDVRP = """\
2 3 3 2
310 80
0 90
 1 37 52 0   7 1 2 1 2
 2 49 49 5  30 1 2 2 1
 3 52 64 0  16 1 2 1 2
 4 20 20 0   0 0 0
 5 60 50 0   0 0 0
"""
TOPTW = """\
5 3 2 4
500 200
 0 -10.442 19.999 0 0 0 0 0 1000
 1 -29.730 64.136 2 12 4 1 15 354 509
 2 -30.664 5.463 7 8 4 2 1 2 234 401
"""
LI_LIM = (
    "25\t200\t1\n0\t40\t50\t0\t0\t1236\t0\t0\t0\n1\t45\t68\t-10\t0\t967\t90\t3\t0\n"
    "2\t42.5\t66\t10\t65\t146\t90\t0\t4\n3\t42\t68\t10\t0\t782\t90\t0\t1\n4\t40\t69\t-10\t15\t367\t90\t2\t0\n"
)
DURATIONS = [[0, 2104, 197, 1299], [2103, 0, 2255, 3152], [197, 2256, 0, 1102], [1299, 3153, 1102, 0]]
VROOM: dict[str, Any] = {
    "vehicles": [
        {"id": 1, "start_index": 0, "end_index": 0, "capacity": [4, 9], "skills": [1, 14], "time_window": [28800, 43200]},
        {"id": 5, "start_index": 0, "end_index": 0, "capacity": [4, 9], "skills": [14, 1], "time_window": [28800, 43200]},
        {"id": 7, "profile": "bike", "start_index": 3, "capacity": [2, 1], "costs": {"fixed": 5, "per_hour": 0, "per_km": 2000},
         "max_travel_time": 5000, "max_distance": 9000},
    ],
    "jobs": [
        {"id": 1, "description": "x", "service": 300, "delivery": [1, 0], "location_index": 1, "skills": [1],
         "time_windows": [[32400, 36000]]},
        {"id": 2, "service": 300, "pickup": [1, 2], "location_index": 2, "priority": 10, "time_windows": [[32400, 36000], [37000, 38000]]},
    ],
    "shipments": [
        {"amount": [1, 3], "skills": [14], "pickup": {"id": 2, "service": 30, "location_index": 2},
         "delivery": {"id": 6, "location_index": 3}},
    ],
    "matrices": {
        "car": {"durations": DURATIONS},
        "bike": {"durations": DURATIONS, "distances": [[v // 2 for v in row] for row in DURATIONS]},
    },
}  # fmt: skip
