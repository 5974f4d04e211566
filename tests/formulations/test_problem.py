import pytest
from coded import check_coded, coded
from file_cases import check_refused

import waybound as wb
from waybound.formulations.problem import Problem, problem_from_instance
from waybound.instances.generating import generate


@pytest.mark.parametrize("name", ["figure-3-3", "cover-30"])
def test_a_problem_knows_no_reason_why_it_should_have_no_answer(name):
    assert list(wb.read(name).infeasibility_reasons()) == []


def test_facts_are_optional():
    assert Problem.facts(wb.read("figure-3-3")) == {}


def test_answers_are_written_as_json_unless_a_problem_says_more():
    problem = wb.read("cover-30")
    problem.check_answer_suffix(".json")
    for suffix in (".sol", ".txt", ""):
        with pytest.raises(
            wb.UsageError, match=r"answers to selection problems are written as \.json, \.csv, \.xlsx, not under the suffix"
        ):
            problem.check_answer_suffix(suffix)
    with pytest.raises(NotImplementedError, match=r"SubmodularSelection .* \.sol"):
        problem.answer_to_text(wb.Selection.of([0]), ".sol")


def test_text_that_is_no_json_is_refused_with_its_first_line():
    with pytest.raises(wb.InputError, match=r"expected JSON; found 'hello'") as caught:
        wb.read("cover-30").answer_from_text("hello\nworld\n")
    assert caught.value.line == 1


GENERATED = {
    "solomon": {"customers": 5}, "uchoa": {"customers": 6}, "random": {"customers": 4}, "sata": {"robots": 3, "targets": 8, "phi": 30},
}  # fmt: skip


KINDS = (
    "assignment", "coverage", "exploration-map", "generalised-assignment", "joint-assignment", "orchard-day", "prm-graph",
    "risk-allocation", "risky-grid", "robot-tasks", *GENERATED,
)  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_family_is_saved_and_read_back_as_the_same_problem(kind, tmp_path):
    instance = generate(kind, 3, **GENERATED.get(kind, {}))
    for name in instance.problems:
        problem = problem_from_instance(instance, name)
        problem.save(tmp_path / "p.json")
        again = wb.read(tmp_path / "p.json")
        assert (again.digest(), again.problem, again.senses, again.name) == (
            problem.digest(), problem.problem, problem.senses, problem.name,
        )  # fmt: skip


SET = [
    ("prm-graph", {"risk": 0.3}), ("assignment", {"match": "robots", "waiting": "sum"}), ("robot-tasks", {"objective": "mini-max"}),
    ("orchard-day", {"objective": "completion"}),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "settings"), SET, ids=lambda value: value if isinstance(value, str) else "")
def test_what_a_problem_was_set_to_is_saved_with_it_and_may_be_set_anew(kind, settings, tmp_path):
    instance = generate(kind, 3)
    problem, plain = problem_from_instance(instance, **settings), problem_from_instance(instance)
    assert problem.digest() != plain.digest()
    problem.save(tmp_path / "p.json")
    assert wb.read(tmp_path / "p.json").digest() == problem.digest()
    key = next(iter(settings))
    assert wb.read(tmp_path / "p.json", **{key: getattr(plain, key)}).digest() != problem.digest()


def test_what_has_no_file_says_so(tmp_path):
    own = wb.SubmodularSelection(wb.UserFunction(lambda chosen: chosen.any(axis=1).astype(float), 2), wb.Cardinality(1))
    check_refused(wb.InputError, "the function user cannot be written to a file", own.save, tmp_path / "p.json")
    check_coded(wb.UsageError, "unknown-name", wb.read("cover-30").save, tmp_path / "p.xyz")
    assert not list(tmp_path.iterdir())


def test_families_without_routes_or_graphs_say_so():
    problem = wb.read("cover-30")
    for ask in (problem.answer_routes, problem.answer_to_networkx, problem.answer_from_frame):
        with pytest.raises(wb.UsageError, check=coded("unsupported")):
            ask(None)
