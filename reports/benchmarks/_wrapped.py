"""A routing library through waybound, a module with the arguments ``engine|whole SOURCE WORK ENGINE SETTINGS``; see ``overhead``."""

import json
import sys
from typing import Any

import waybound as wb

from ._bare_routing import tell

part, source, work, engine, settings = sys.argv[1:]
problem = wb.read(source, **json.loads(settings))
options: dict[str, Any] = {"exploration_level": int(work)} if engine == "vroom" else {}
limits: dict[str, Any] = {} if engine == "vroom" else {"iterations": int(work)}
if part == "whole":
    answer, seconds = wb.solve(problem, engine, time_limit=3600.0, seed=1, bound_time=0, options=options, **limits).answer, None
else:
    import importlib
    import time

    from waybound.solvers.backend import BACKENDS, Control, Options

    backend: Any = BACKENDS[engine]()
    for module in backend.modules:
        importlib.import_module(module)
    start = time.process_time()
    answer = backend.run(problem, Options(time_limit=3600.0, seed=1, extra=options, **limits), Control()).answer
    seconds = time.process_time() - start
tell([list(route.visits) for route in answer], seconds)
