"""Tests mirror the code: the tests of ``formulations/sata/x.py`` are in ``tests/formulations/sata/test_x.py``."""

import ast
import importlib
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parent
ROOT = TESTS.parent
FLOORS = ("instances", "formulations", "solvers", "heuristics", "reports", "waybound")

KERNELS = {
    "formulations/auctions/matching_kernels": "formulations/auctions/matching",
    "formulations/routing/checking/cheap_route_kernels": "formulations/routing/checking/enumerated_routes",
    "formulations/routing/checking/state_space_kernels": "formulations/routing/checking/state_space",
    "formulations/routing/checking/walk_kernels": "formulations/routing/checking/walks",
    "heuristics/auctions/auction_steps/bidding_kernels": "heuristics/auctions/sequential_single_item",
    "formulations/transpose_kernels": "heuristics/sata/greedy_steps/picking",
    "heuristics/auctions/conflict_kernels": "heuristics/auctions/conflict_auction",
    "heuristics/routing/insertion_steps/assignment_kernels": "heuristics/routing/greedy_assignment",
    "heuristics/routing/savings_steps/merging_kernels": "heuristics/routing/savings",
    "heuristics/sata/greedy_steps/bottleneck_kernels": "heuristics/sata/greedy",
    "heuristics/sata/greedy_steps/enumeration_kernels": "heuristics/sata/brute_force",
    "heuristics/sata/greedy_steps/filling_kernels": "heuristics/sata/knapsack_greedy",
    "heuristics/sata/greedy_steps/loops_kernels": "heuristics/sata/greedy_steps/picking",
    "solvers/bounds/auctions/forest_kernels": "solvers/bounds/auctions/task_forest",
    "reports/missions/auctions/orchard_days/day_kernels": "reports/missions/auctions/orchard_days/days",
    "solvers/bounds/routing/enumeration_kernels": "solvers/bounds/routing/enumerated_routes",
    "solvers/bounds/routing/route_row_kernels": "solvers/bounds/routing/route_rows",
    "solvers/bounds/routing/label_kernels": "solvers/bounds/routing/pricing",
    "solvers/bounds/routing/subset_row_kernels": "solvers/bounds/routing/subset_rows",
    "solvers/bounds/routing/state_space_kernels": "solvers/bounds/routing/state_space",
    "solvers/bounds/sata/gain_kernels": "solvers/bounds/sata/growing_sets",
    "solvers/bounds/sata/price_kernels": "solvers/bounds/sata/item_prices",
    "solvers/engines/auctions/assignment_steps/auction_kernels": "solvers/engines/auctions/assignment_steps/auction",
    "solvers/engines/auctions/assignment_steps/price_kernels": "solvers/engines/auctions/assignment_steps/recovered_prices",
    "solvers/engines/routing/ruin_recreate_steps/near_kernels": "solvers/engines/routing/ruin_recreate_steps/arrays",
    "solvers/engines/routing/ruin_recreate_steps/reload_kernels": "solvers/engines/routing/ruin_recreate_steps/search_kernels",
    "solvers/engines/routing/ruin_recreate_steps/route_kernels": "solvers/engines/routing/ruin_recreate_steps/search_kernels",
    "solvers/engines/routing/ruin_recreate_steps/shipment_kernels": "solvers/engines/routing/ruin_recreate_steps/search_kernels",
    "solvers/engines/sata/local_max_min/lane_kernels": "solvers/engines/sata/local_max_min/level_kernels",
    "solvers/engines/sata/local_max_min/layer_kernels": "solvers/engines/sata/local_max_min/shares",
    "solvers/engines/sata/local_max_min/level_kernels": "solvers/engines/sata/local_max_min/search",
    "solvers/engines/sata/saddle_steps/descent_kernels": "solvers/engines/sata/saddle_steps/game",
    "solvers/engines/sata/saddle_steps/multigrid_kernels": "solvers/engines/sata/saddle_steps/multigrid",
    "solvers/engines/sata/saddle_steps/normal_kernels": "solvers/engines/sata/saddle_steps/normal_matrix",
    "solvers/engines/sata/saddle_steps/halpern_kernels": "solvers/engines/sata/saddle_steps/halpern",
    "solvers/engines/sata/saddle_steps/packing_covering_kernels": "solvers/engines/sata/saddle_steps/packing_covering",
    "solvers/engines/sata/saddle_steps/restarts_kernels": "solvers/engines/sata/saddle_steps/halpern_kernels",
    "solvers/engines/sata/saddle_steps/regret_kernels": "solvers/engines/sata/saddle_steps/game",
    "solvers/engines/sata/saddle_steps/sums_kernels": "solvers/engines/sata/saddle_steps/normal_matrix",
    "solvers/engines/auctions/task_subset_steps/part_kernels": "solvers/engines/auctions/task_subsets",
    "solvers/engines/auctions/task_subset_steps/subset_kernels": "solvers/engines/auctions/task_subsets",
}
"""Compiled loops that take their caller's arrays apart, and mean nothing without it: the tests of the caller are theirs."""

COMMANDS = {
    "reports/tables/routing_features",
}
"""Old names of commands, a line each: ``python -m`` finds them here, and their modules in a wing."""

ELSEWHERE = {
    "formulations/checking/row_duals": "formulations/arrays/checking/test_lp_dual.py",  # its arithmetic
    "instances/sata/worlds/_plane": "instances/sata/worlds/test_tracking.py",
    "reports/plots/positions": "reports/plots/routing/test_routes.py",
    "reports/benchmarks/_bare_highs": "reports/benchmarks/test_highs_versions.py",  # a script that knows nothing of waybound
    "reports/benchmarks/_bare_routepricer": "reports/benchmarks/test_pricing_alone.py",
    **{f"reports/benchmarks/_bare_{name}": "reports/benchmarks/test_overhead.py" for name in ("ortools", "pyvrp", "routing", "vroom")},
    "solvers/engines/sata/local_max_min/records": "solvers/engines/sata/local_max_min/test_search.py",  # names of arrays
    "solvers/engines/sata/saddle_steps/layout": "solvers/engines/sata/saddle_steps/test_game.py",  # names of arrays
    "reports/benchmarks/_wrapped": "reports/benchmarks/test_overhead.py",
    "waybound/_version": "test_packaging.py",  # one line
    "waybound/_guard": "conformance/test_imports.py",  # one line, which fails where it must: in other processes
}
"""Modules without a test of their own, and where they are tested."""

STUDIES = "reports/studies/"
FAMILIES = "/families/"
"""A study is a table of what is to be run; ``tests/ratios`` runs those of guarantees, ``tests/reports/studies`` all short forms."""

NOTEBOOKS = "reports/notebooks/"
"""A notebook is a script of cells; building the documentation executes every one, and ``tests/docs`` reads them."""


def modules() -> Iterator[Path]:
    """Every module of every floor but packages, relative to the root."""
    for floor in FLOORS:
        for path in sorted((ROOT / floor).rglob("*.py")):
            links = any(part.is_symlink() for part in (path, *path.parents))
            if not links and not path.name.startswith("__"):
                yield path.relative_to(ROOT)


def mirrored(module: Path) -> Path:
    """Where its test belongs, relative to ``tests``; the face stands at the root of the tests, and a leading _ is no part of a name."""
    place = module.relative_to("waybound") if module.parts[0] == "waybound" else module
    return place.parent / f"test_{place.stem.lstrip('_')}.py"


def name_of(module: Path) -> str:
    return module.with_suffix("").as_posix()


def is_study(module: Path) -> bool:
    """In a room of a wing; families of instances and what begins with _ are read by studies, and have tests of their own."""
    return (
        name_of(module).startswith(STUDIES)
        and len(module.parts) > 3
        and FAMILIES not in name_of(module)
        and not module.name.startswith("_")
    )


def test_every_module_has_its_test_where_it_is_mirrored() -> None:
    known = {*KERNELS, *ELSEWHERE, *COMMANDS}
    own = [
        module
        for module in modules()
        if name_of(module) not in known and not is_study(module) and not name_of(module).startswith(NOTEBOOKS)
    ]
    assert [f"{module} has no tests/{mirrored(module)}" for module in own if not (TESTS / mirrored(module)).exists()] == []


def test_no_two_modules_share_a_test() -> None:
    places = [mirrored(module) for module in modules()]
    assert len(set(places)) == len(places)


@pytest.mark.parametrize("kernels", KERNELS)
def test_an_exception_is_made_only_for_compiled_loops_whose_caller_has_tests(kernels: str) -> None:
    caller = KERNELS[kernels]
    while caller in KERNELS:  # loops that other loops are made of
        assert kernels.rsplit("/", 1)[1] in (ROOT / f"{caller}.py").read_text()
        kernels, caller = caller, KERNELS[caller]
    assert (TESTS / mirrored(Path(f"{caller}.py"))).exists()
    assert kernels.rsplit("/", 1)[1] in (ROOT / f"{caller}.py").read_text(), f"{caller} does not use {kernels}"
    for node in ast.parse((ROOT / f"{kernels}.py").read_text()).body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            assert node.decorator_list, f"{kernels}.{node.name} is not compiled, and can be tested by itself"


@pytest.mark.parametrize("module", ELSEWHERE)
def test_an_exception_is_made_only_for_modules_that_have_none_and_names_tests_that_are_there(module: str) -> None:
    assert not (TESTS / mirrored(Path(f"{module}.py"))).exists()
    assert (TESTS / ELSEWHERE[module]).exists()


def test_every_module_of_studies_registers_one_so_that_all_are_run() -> None:
    for module in modules():
        if is_study(module):
            text = (ROOT / module).read_text()
            assert any(word in text for word in ("guarantee_study(", "experiment(", "STUDIES.add(", "@study(")), module


@pytest.mark.parametrize("command", sorted(COMMANDS))
def test_a_command_keeps_its_old_name_and_is_that_of_a_wing(command: str) -> None:
    main = importlib.import_module(f"waybound.{command.replace('/', '.')}").main
    folder, _, name = command.rpartition("/")
    assert re.fullmatch(rf"waybound[.]{folder.replace('/', '[.]')}[.][a-z]+[.]{name}", main.__module__)
