"""``waybound export, convert, generate``."""

from __future__ import annotations

import json

import pytest

import waybound as wb


@pytest.mark.parametrize("suffix", [".mps", ".lp"])
def test_export_writes_a_program_that_highs_reads_back(run, tmp_path, suffix):
    import highspy

    path = tmp_path / f"model{suffix}"
    result = run("export", "demo-tiny", "--form", "two-index-mtz", "--to", path)
    assert result.exit_code == 0
    made = wb.read("demo-tiny").compile("two-index-mtz")
    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    assert model.readModel(str(path)) == highspy.HighsStatus.kOk
    assert model.getNumCol() == made.program.num_variables
    model.run()
    best = wb.solve(made, "highs", bound_time=0).objective
    assert model.getInfo().objective_function_value == pytest.approx(best, abs=1e-6)
    assert f"{made.program.num_variables} variables" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--to", "model.txt"), "suffix"),
        (("--to", "missing/model.mps"), "no folder"),
        (("--to", "model.mps", "--form", "four-index"), "unknown form"),
    ],
)
def test_export_refuses_before_it_writes(refused, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    assert says in refused("export", "demo-tiny", *arguments)
    assert list(tmp_path.iterdir()) == []


def test_an_instance_survives_conversion(run, tmp_path):
    assert run("convert", "demo-c25", "--to", tmp_path / "c.json").exit_code == 0
    before, after = wb.read("demo-c25", convention="trunc1"), wb.read(tmp_path / "c.json", convention="trunc1")
    answer = wb.Routes.of([[1, 2, 3], [4, 5]])
    assert before.evaluate(answer) == after.evaluate(answer)


def test_conversion_names_what_a_format_cannot_express(run, refused, tmp_path):
    path, target = tmp_path / "least.json", tmp_path / "least.txt"
    assert run("convert", "demo-tiny", "--to", path).exit_code == 0
    path.write_text(json.dumps({**json.loads(path.read_text()), "min_vehicles": 2}))
    told = refused("convert", path, "--to", target, "--to-format", "solomon")
    assert "no place for" in told
    assert "min-vehicles" in told
    assert not target.exists()


def test_conversion_does_not_overwrite_its_input(run, refused, tmp_path):
    path = tmp_path / "c.json"
    assert run("convert", "demo-tiny", "--to", path).exit_code == 0
    kept = path.read_bytes()
    assert "overwrite the input" in refused("convert", path, "--to", path)
    assert path.read_bytes() == kept


def test_generation_repeats_itself_from_the_seed(run, tmp_path):
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        result = run("generate", "random", "--set", "customers=6", "--set", "name=x", "--seed", seed, "--out", tmp_path / f"{name}.json")
        assert result.exit_code == 0
    a, b, c = ((tmp_path / f"{name}.json").read_text() for name in "abc")
    assert a == b != c
    made = wb.read(tmp_path / "a.json")
    assert isinstance(made, wb.RoutingProblem)
    assert len(made.customers) == 6


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("nonsense",), "choose from"),
        (("random", "--set", "colour=red"), "colour"),
        (("random", "--set", "customers=-1"), "customers"),
        (("random", "--set", "seed=1"), "--seed"),
        (("random", "--seed", "-1"), "seed"),
    ],
)
def test_generation_refuses_what_it_does_not_know(refused, tmp_path, arguments, says):
    assert says in refused("generate", *arguments, "--out", tmp_path / "a.json")
    assert list(tmp_path.iterdir()) == []
