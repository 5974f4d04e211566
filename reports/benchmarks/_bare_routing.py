"""Integers in, routes and CPU seconds out, for the scripts that drive a bare routing library. No waybound in here.

The arrays, by name: one entry a site of ``xy``, ``service``, ``ready``, ``due``, ``demand``, ``pickup``, ``prize`` and ``required``, square
ones of ``distance`` and ``duration``, ``depots``; the two ends and the load of each pair, ``shipments`` and ``shipped``; for each kind of
vehicle how many there are, ``vehicles``, their ``start``, ``end``, ``capacity``, ``fixed`` cost, cost of a ``unit`` of distance, the times
from which and until which they drive, ``opens`` and ``closes``, ``max_duration`` and ``max_distance``; the cost of a unit of the longest
route, ``span``, and what its moves count, ``spanned``; and whether times matter, ``timed``.
"""

import json
import resource
from typing import Any

import numpy as np

UNLIMITED = int(np.iinfo(np.int64).max)


def load(path: str) -> dict[str, Any]:
    """The arrays of a file."""
    return dict(np.load(path))


def tell(routes: list[list[int]], engine: float | None) -> None:
    """Print routes, CPU seconds of the library, and of the whole process, as JSON."""
    usage = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    whole = sum(u.ru_utime + u.ru_stime for u in usage)
    print(json.dumps({"routes": sorted(r for r in routes if r), "engine": engine, "whole": whole}))
