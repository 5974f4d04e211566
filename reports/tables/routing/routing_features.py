"""Routing features that each form, engine and heuristic declares: the page docs/formulations/routing-features.md.

``python -m waybound.reports.tables.routing_features docs/formulations/routing-features.md`` writes it anew.
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ....formulations.forms import FORMS
from ....formulations.programs.exactness import Exactness
from ....formulations.routing.objective import TERMS
from ....formulations.routing.problem import RoutingProblem
from ....heuristics.heuristic import HEURISTICS
from ....instances.atomic import atomic_write
from ....instances.routing.features import FEATURES, UNASKED
from ....instances.routing.instance import Sites, VehicleType
from ....instances.routing.travel import Travel
from ....solvers.backend import BACKENDS, Engine
from ....solvers.program_backend import ProgramBackend

PAGE = "docs/formulations/routing-features.md"

ROWS = (
    *(name for name in FEATURES if name not in UNASKED), *(f"objective:{name}" for name in TERMS), "objective:weights",
    "objective:priorities",
)  # fmt: skip
"""All features that a routing problem may ask of a solver, as ``RoutingProblem.features`` names them."""

PAGE_TEXT = """# Routing: features and the methods that take them

Generated from what forms, engines and heuristics declare, by `python -m waybound.reports.tables.routing_features {page}`.
Features are those of [the problem](routing.md#features) and its [objective](routing.md#objectives). An empty cell is a refusal by the
feature's name, and so is a combination that a method cannot take though it takes each feature of it, such as limited durations with waiting
in the two-index forms: `wb.solvers(problem)` and `wb.heuristics(problem)` say what each lacks for a problem at hand. Every cell is tried on
small problems (`tests/conformance/test_routing_features.py`).

## Exact solvers

Solvers of programs find optima through forms:

{through}

{forms}

## Engines

They search routes, and prove nothing by themselves. `vrpsolver` says that it does, without evidence.

{engines}

## Heuristics

Their guarantees are listed [there](routing.md#approximations).

{heuristics}
"""


def declared_by_forms() -> dict[str, frozenset[str]]:
    """Features of each exact routing form, the default first."""
    exact = (form for form in FORMS.values() if form.family == "routing" and form.exactness is Exactness.EXACT)
    forms = sorted(exact, key=lambda form: form.order)
    return {form.name: form.features for form in forms}


def declared_by_engines() -> dict[str, frozenset[str]]:
    """Features of each engine for routing problems, installed or not."""
    engines = [b for b in (BACKENDS[name] for name in BACKENDS) if issubclass(b, Engine) and b.family == "routing"]
    return {engine.name: engine.features for engine in engines}


def declared_by_heuristics() -> dict[str, frozenset[str]]:
    """Features of each heuristic for routing problems."""
    return {name: HEURISTICS[name].features for name in HEURISTICS if "routing" in HEURISTICS[name].families}


def solvers_of_forms() -> dict[tuple[str, ...], list[str]]:
    """Solvers of programs, those that take programs of the same forms together."""
    here = np.zeros((2, 2))
    plain = RoutingProblem(Sites.of(range(2)), Travel("euclidean", here), (VehicleType(),))
    solvers: dict[tuple[str, ...], list[str]] = {}
    for name in BACKENDS:
        backend = BACKENDS[name]
        if issubclass(backend, ProgramBackend):
            forms = tuple(form for form in declared_by_forms() if backend.takers(FORMS[form].makes(plain)))
            solvers.setdefault(forms, []).append(name)
    return {forms: names for forms, names in solvers.items() if forms}


def _table(declared: Mapping[str, frozenset[str]]) -> list[str]:
    head = ["feature", *(f"`{name}`" for name in declared)]
    rows = [[f"`{row}`", *("yes" if row in features else "" for features in declared.values())] for row in ROWS]
    return ["| " + " | ".join(line) + " |" for line in (head, ["---"] * len(head), *rows)]


def page() -> str:
    """The whole page."""
    through = []
    for forms, names in solvers_of_forms().items():
        every = "every form" if forms == tuple(declared_by_forms()) else ", ".join(f"`{form}`" for form in forms)
        through.append(f"- {', '.join(f'`{name}`' for name in names)}: {every}")
    return PAGE_TEXT.format(
        page=PAGE,
        through="\n".join(through),
        forms="\n".join(_table(declared_by_forms())),
        engines="\n".join(_table(declared_by_engines())),
        heuristics="\n".join(_table(declared_by_heuristics())),
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the page where the command line says."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("page", type=Path, help=f"where to write it: {PAGE}")
    atomic_write(parser.parse_args(arguments).page, page())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
