"""The face: what a notebook types."""

import ast
import io
import json
import subprocess
import sys
from pathlib import Path

import pytest
from coded import check_coded, coded
from file_cases import check_refused
from programs import Counting

import waybound as wb
from waybound.formulations.answers import write_answer
from waybound.instances.bundled import bundled_path
from waybound.solvers.backend import BACKENDS

HEAVY = ("highspy", "ortools", "pulp", "cvxpy", "pyvrp", "pandas", "scipy", "numba", "matplotlib", "networkx")


def in_fresh_process(code: str) -> str:
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return run.stdout.strip()


def test_import_loads_no_solver_no_pandas_and_no_scipy():
    loaded = in_fresh_process("import sys, waybound; print(*{m.split('.')[0] for m in sys.modules})").split()
    assert not set(loaded) & set(HEAVY)


def test_reading_and_judging_load_no_solver():
    code = "import sys, waybound as wb; wb.check(wb.read('demo-tiny'), wb.Routes.of([[1]])); print(*{m.split('.')[0] for m in sys.modules})"
    assert not set(in_fresh_process(code).split()) & {"highspy", "ortools", "pulp", "cvxpy", "pyvrp"}


def test_a_table_of_solvers_loads_neither_random_numbers_nor_processes():
    """What only annotations or a run need is not imported to tell which solvers there are."""
    loaded = in_fresh_process("import sys, waybound as wb, waybound.extending; wb.solvers(); print(*sys.modules)").split()
    assert not set(loaded) & {"numpy.random", "multiprocessing", "waybound.solvers.isolation", "waybound.solving.method"}


@pytest.mark.parametrize("name", wb.__all__)
def test_every_public_name_exists_and_is_listed(name):
    assert getattr(wb, name) is not None
    assert name in dir(wb)


def test_editors_are_told_of_every_public_name_where_it_is_found():
    """What stands under ``TYPE_CHECKING`` is what mypy, pyright and completion see; what ``_WHERE`` names is what Python imports."""
    source = ast.parse(Path(wb.__file__).read_text())
    (block,) = [n for n in source.body if isinstance(n, ast.If) and isinstance(n.test, ast.Name) and n.test.id == "TYPE_CHECKING"]
    imports = [statement for statement in block.body if isinstance(statement, ast.ImportFrom)]
    assert {alias.asname: statement.module for statement in imports for alias in statement.names if alias.asname} == wb._WHERE
    (tables,) = [ast.unparse(statement) for statement in block.body if statement not in imports]
    assert tables == "heuristics, solvers = (list_heuristics, list_solvers)"
    assert {*wb._WHERE, "heuristics", "solvers", "__version__"} == set(wb.__all__)


def test_completion_lists_public_names_and_no_private_ones_before_them():
    listed = [name for name in dir(wb) if not name.startswith("_")]
    assert set(wb.__all__) - {"__version__"} <= set(listed)
    assert len(listed) == len(set(listed))


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no_such_thing"):
        wb.no_such_thing  # noqa: B018


@pytest.mark.share(3)
@pytest.mark.parametrize("before", ["", "import waybound.solving.solve", "import waybound.heuristics.heuristic, waybound.solvers"])
@pytest.mark.parametrize("after", ["", "import waybound.solvers.backend; import waybound.heuristics.routing.savings"])
def test_solvers_and_heuristics_are_callable_whatever_was_imported_first(before, after):
    code = f"{before}\nimport waybound as wb\nwb.solvers\n{after}\nprint(len(wb.solvers()), len(wb.heuristics()), wb.solvers.__name__)"
    solvers, heuristics, name = in_fresh_process(code).split()
    assert int(solvers) >= 4
    assert int(heuristics) >= 1
    assert name == "waybound.solvers"


def test_the_packages_can_still_be_imported_from():
    code = "from waybound.solvers import backend; from waybound import heuristics; print(backend.__name__, heuristics.__name__)"
    assert in_fresh_process(code) == "waybound.solvers.backend waybound.heuristics"


def test_read_takes_a_bundled_name_and_settings_as_keywords():
    problem = wb.read("demo-c25", convention="dimacs", customers=10, vehicles_exactly=3)
    assert isinstance(problem, wb.RoutingProblem)
    assert (len(problem.customers), problem.min_vehicles, problem.vehicle_limit, problem.convention) == (10, 3, 3, "trunc1")


def test_a_file_goes_before_the_bundled_instance_of_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "demo-c25").write_text(bundled_path("demo-x40").read_text())
    assert wb.read("demo-c25").name == wb.read("demo-x40").name


def test_an_unknown_setting_is_refused_by_name():
    with pytest.raises(wb.UsageError, match="colour"):
        wb.read("demo-c25", colour="red")


@pytest.fixture(scope="module")
def solved():
    problem = wb.read("demo-tiny")
    return problem, wb.solve(problem, heuristic="savings", bound_time=60.0)


def test_check_takes_solutions_answers_and_files(solved, tmp_path):
    problem, solution = solved
    write_answer(solution, tmp_path / "a.sol")
    verdicts = [wb.check(problem, given) for given in (solution, solution.answer, tmp_path / "a.sol", str(tmp_path / "a.sol"))]
    assert all(v.feasible for v in verdicts)
    assert {v.objective for v in verdicts} == {solution.objective}


def test_check_verifies_a_certificate_given_as_object_mapping_or_file(solved, tmp_path):
    problem, solution = solved
    data = solution.certificate.to_json(with_evidence=True)
    (tmp_path / "c.json").write_text(json.dumps(data))
    bounds = {wb.check(problem, solution, c).bound for c in (solution.certificate, data, tmp_path / "c.json")}
    assert bounds == {solution.certificate.bound}
    assert solution.certificate.bound is not None


def test_check_refuses_a_certificate_that_states_more_than_it_proves(solved):
    problem, solution = solved
    data = {**solution.certificate.to_json(with_evidence=True), "bound": solution.objective + 1000.0}
    with pytest.raises(wb.CheckFailedError, match="proves"):
        wb.check(problem, solution, data)


def test_check_without_an_answer_says_so(solved):
    with pytest.raises(wb.UsageError, check=coded("missing")):
        wb.check(solved[0], None)


def test_bound_is_a_certificate_without_an_answer(solved):
    problem, solution = solved
    made = wb.bound(problem, bound_time=60.0)
    assert made.feasible is None
    assert made.bound is not None
    assert made.bound <= solution.objective + 1e-6


def test_bounding_is_told_who_solves_linear_programs_and_with_what(registered):
    registered(BACKENDS, "counting", Counting)
    Counting.told.clear()
    problem = wb.read("sata-s3")
    own, named = wb.bound(problem, bound_time=20.0), wb.bound(problem, bound_time=20.0, lp_solver="counting", seed=9, threads=2)
    assert own.bound is not None and named.bound == pytest.approx(own.bound)
    assert {(options.seed, options.threads) for _, options in Counting.told} == {(9, 2)}
    with pytest.raises(wb.UsageError, match="unknown solver 'hihgs'"):
        wb.bound(problem, lp_solver="hihgs")
    for wrong in ({"seed": -1}, {"threads": 0}):
        with pytest.raises(wb.UsageError, match="must be a whole number"):
            wb.bound(problem, **wrong)


@pytest.mark.parametrize("call", [lambda p: wb.bound(p), lambda p: wb.explain(p), lambda p: wb.check(p, wb.Routes.of([[1]]))])
def test_a_path_in_place_of_a_problem_is_answered_with_what_to_type(call):
    with pytest.raises(wb.UsageError, match=r"takes a problem, not a path: \w+\(read\('demo-tiny'\)\)"):
        call("demo-tiny")


def test_bound_needs_time():
    with pytest.raises(wb.UsageError, match="positive"):
        wb.bound(wb.read("demo-tiny"), bound_time=0.0)


def test_explain_names_the_site_that_no_vehicle_can_serve():
    made = wb.explain(wb.read("demo-tiny", capacity=9))
    assert made.verdict == "infeasible"
    assert all(r.kind == "site" for r in made.reasons)


def test_solution_and_certificate_show_themselves_as_text_html_and_rich(solved):
    from rich.console import Console

    _, solution = solved
    screen = io.StringIO()
    console = Console(width=200, file=screen)
    console.print(solution.certificate)
    console.print(solution)
    rich_text = screen.getvalue()
    assert rich_text.count("feasible: all") == 2
    for shown in (repr(solution.certificate), solution.certificate._repr_html_(), solution._repr_html_(), str(solution), rich_text):
        assert "feasible: all" in shown
        assert "recomputed from the data" in shown


def test_a_problem_shows_itself_in_one_line():
    expected = "<RoutingProblem demo-tiny: vrptw, 7 customers, at most 3 vehicles, min total-cost, convention exact>"
    assert repr(wb.read("demo-tiny")) == expected


@pytest.mark.parametrize("given", [[["1", "2"], ["3"]], {"vehicle": [["1", "2"], ["3"]]}, wb.Routes.of([[1, 2], [3]])])
def test_judge_takes_anything_and_says_what_is_broken(given):
    verdict = wb.judge(wb.read("demo-tiny"), given)
    assert not verdict.feasible and {v.check for v in verdict.violations} == {"visits"}


def test_judge_refuses_what_it_cannot_read():
    problem = wb.read("demo-tiny")
    check_coded(wb.UsageError, "malformed", wb.judge, "demo-tiny", [[1]])
    check_coded(wb.UsageError, "missing", wb.judge, problem, None)
    check_refused(wb.UsageError, "is no list of routes", wb.judge, problem, 5)


def test_a_checkout_without_links_says_what_to_do(tmp_path: Path) -> None:
    package = tmp_path / "waybound"
    package.mkdir()
    for file in Path(wb.__file__).parent.glob("*.py"):
        (package / file.name).write_bytes(file.read_bytes())
    for folder in ("formulations", "heuristics", "instances", "reports", "solvers"):
        (package / folder).write_text(f"../{folder}", encoding="utf-8")
    run = subprocess.run([sys.executable, "-c", "import waybound"], cwd=tmp_path, capture_output=True, text=True, check=False)
    message = run.stderr.partition("ModuleNotFoundError: ")[2].strip().split("\n")
    assert run.returncode == 1 and len(message) == 3 and "core.symlinks=true" in message[1], run.stderr
