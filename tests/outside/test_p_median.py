"""The family of docs/adding-a-problem.md: small, of one import, and right in what it proves, whatever it is given."""

import importlib.util
import itertools
import math
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from file_cases import check_refused

import waybound as wb
from waybound.extending import CHECKERS, FORMS, KINDS, PLOTS, PROBLEMS, Evidence, InputError, UsageError, verified_bound

from ..docs.run_page import FENCE
from ..solving.test_any_start import BROKEN, SHAPES, refusal

PAGE = Path(__file__).resolve().parents[2] / "docs" / "adding-a-problem.md"
FILES = {name: text for name, _, text in FENCE.findall(PAGE.read_text(encoding="utf-8")) if name}
MOST_LINES = 250
"""Of all that is to be written for the family: data, JSON, judge, answers, picture, form, checker, and how it is installed."""


@pytest.fixture
def made(registered: Callable[..., Any], tmp_path: Path) -> Iterator[ModuleType]:
    """The modules of the page, registered as its ``pyproject.toml`` has it; the first of them."""
    found: dict[str, ModuleType] = {}
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
        if name.endswith(".py"):
            spec = importlib.util.spec_from_file_location(name[:-3], tmp_path / name)
            assert spec is not None and spec.loader is not None
            module = sys.modules[name[:-3]] = found[name[:-3]] = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
    family = found["p_median"]
    registered(KINDS, "places", family.KIND)
    registered(PROBLEMS, "p-median", family.make)
    registered(PLOTS, "location", family.plot)
    registered(FORMS, "p-median", found["p_median_form"].FORM)
    registered(CHECKERS, "median-prices", found["p_median_checker"].check)
    yield family
    for name in found:
        del sys.modules[name]


def drawn(family: ModuleType, rng: np.random.Generator) -> Any:
    customers, sites = int(rng.integers(1, 7)), int(rng.integers(1, 7))
    cost = rng.integers(0, 10, (customers, sites)) * float(rng.choice([1.0, 0.1, 1e9]))
    return family.PMedian(family.Places(cost=cost, medians=int(rng.integers(1, sites + 2))))


def best(problem: Any, taken: set[int], dropped: set[int]) -> float:
    """The least cost of all answers that open the ones and not the others; infinite where there is none."""
    sites, p = range(problem.num_elements), problem.places.medians
    choices = itertools.chain.from_iterable(itertools.combinations(sites, k) for k in range(1, min(p, len(sites)) + 1))
    costs = [problem.evaluate(c).values[0] for c in choices if taken <= set(c) and not dropped & set(c)]
    return min(costs, default=math.inf)


def test_it_is_small() -> None:
    lines = {name: len(text.splitlines()) for name, text in FILES.items() if not name.endswith(".json")}
    assert {"p_median.py", "p_median_form.py", "p_median_checker.py", "pyproject.toml"} == set(lines)
    assert sum(lines.values()) <= MOST_LINES


@pytest.mark.parametrize("seed", range(12))
def test_any_prices_bound_the_answers_of_any_decisions(made: ModuleType, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(20):
        problem = drawn(made, rng)
        asked = [(k, bool(rng.random() < 0.5)) for k in rng.integers(0, problem.num_elements, int(rng.integers(0, 4))).tolist()]
        part = problem.restricted([({"chosen": k}, holds) for k, holds in asked])
        truth = best(problem, {k for k, holds in asked if holds}, {k for k, holds in asked if not holds})
        for scale in (0.0, 1.0, 30.0, 1e200):
            prices = (rng.random(len(problem.places.cost)) * scale * float(problem.places.cost.max(initial=1.0))).tolist()
            bound = verified_bound(part, Evidence("median-prices", "", 0.0, {"prices": prices}))
            assert bound <= truth
            assert (bound == math.inf) == (truth == math.inf)


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow), pytest.param(3, marks=pytest.mark.slow)])
def test_trees_prove_optima(made: ModuleType, seed: int) -> None:
    """Customers near or far: relaxations of such problems are weak."""
    rng, leaves = np.random.default_rng(seed), 0
    for _ in range(3):
        cost = rng.integers(1, 9, 60)[:, None] * (rng.random((60, 14)) < 0.75)
        problem = made.PMedian(made.Places(cost=cost, medians=4))
        solution = wb.solve(problem, "highs", bound_time=10.0)
        assert solution.objective == best(problem, set(), set())
        assert (solution.status, solution.bound_kind) == ("optimal", "verified")
        leaves += str(solution.certificate.evidence[0].data).count("median-prices")
    assert leaves > 6


def test_what_it_writes_it_reads(made: ModuleType, tmp_path: Path) -> None:
    problem = wb.read(tmp_path / "villages.json")
    problem.save(tmp_path / "again.json")
    assert wb.read(tmp_path / "again.json").digest() == problem.digest()
    assert wb.read(tmp_path / "villages.json", p=3).digest() != problem.digest()
    answer = (2, 4)
    assert problem.answer_from_json(problem.answer_to_json(answer)) == answer
    solution = wb.solve(problem, "highs", bound_time=0)
    solution.save(tmp_path / "answer.json")
    assert wb.judge(problem, tmp_path / "answer.json").objective == 11.0
    assert solution.plot().get_title(loc="left").startswith("villages")
    check_refused(InputError, "cost", made.Places, cost=[[-1.0]])
    check_refused(UsageError, "has no setting q", wb.read, tmp_path / "villages.json", q=3)


@pytest.mark.parametrize("shape", [*SHAPES, *BROKEN])
def test_a_start_of_any_shape_is_refused_in_one_line(made: ModuleType, tmp_path: Path, shape: str) -> None:
    assert refusal(wb.read(tmp_path / "villages.json"), {**SHAPES, **BROKEN}[shape]()) is not None
