from pathlib import Path

from waybound.formulations.routing.objective import TERMS
from waybound.instances.routing.features import FEATURES, UNASKED
from waybound.reports.tables.routing.routing_features import PAGE, ROWS, declared_by_forms, main, page, solvers_of_forms

ROOT = Path(__file__).resolve().parents[4]


def test_the_page_is_generated() -> None:
    written = (ROOT / PAGE).read_text(encoding="utf-8")
    assert written == page(), f"python -m waybound.reports.tables.routing_features {PAGE}"


def test_the_command_writes_it(tmp_path: Path) -> None:
    assert main([str(tmp_path / "page.md")]) == 0
    assert (tmp_path / "page.md").read_text(encoding="utf-8") == page()


def test_rows_are_all_that_a_problem_asks() -> None:
    assert set(ROWS) >= (FEATURES.keys() - UNASKED) | {f"objective:{name}" for name in TERMS}
    assert len(set(ROWS)) == len(ROWS)


def test_every_form_has_a_solver() -> None:
    assert {form for forms in solvers_of_forms() for form in forms} == set(declared_by_forms())
