"""``waybound run``."""

import json
import os
import signal

import pandas as pd
import pytest

import waybound as wb
from waybound.reports.missions.sata.tracking import Tracking

SMALL = ("--set", "robots=3", "--set", "targets=4", "--set", "width=60", "--set", "height=60")


@pytest.mark.parametrize("decider", [("--solver", "highs"), ("--heuristic", "greedy"), ("--policy", "force-vector"), ()])
def test_a_mission_is_played_and_summed_up(run, decider):
    result = run("run", "tracking", *decider, "--steps", 3, "--seed", 2, *SMALL, code=0)
    assert f"tracking, {' '.join(decider).removeprefix('--') or 'default'}: 3 steps, seed 2" in result.stdout
    assert result.stdout.index("observed") < result.stdout.index("components")
    assert "status of steps" in result.stdout


def test_json_is_one_object_with_every_row_and_the_log_file_has_the_same(run, strict_json, tmp_path):
    path = tmp_path / "log.csv"
    result = run("run", "tracking", "--heuristic", "random", "--steps", 4, "--seed", 2, *SMALL, "--out", path, "--json", "-q", code=0)
    assert result.stderr == ""
    data = strict_json(result.stdout)
    figures = [data[key] for key in ("mission", "heuristic", "policy", "seed", "steps", "limit")]
    assert figures == ["tracking", "random", None, 2, 4, "none"]
    assert data["settings"] == {"robots": 3, "targets": 4, "width": 60, "height": 60}
    assert [row["step"] for row in data["rows"]] == [1, 2, 3, 4]
    log = pd.read_csv(path)
    assert log["observed"].tolist() == [row["observed"] for row in data["rows"]]
    assert data["means"]["observed"] == pytest.approx(log["observed"].mean())
    same = wb.run("tracking", heuristic="random", steps=4, seed=2, robots=3, targets=4, width=60, height=60)
    assert log["observed"].tolist() == same["observed"].tolist()
    assert list(log.columns) == list(same.columns)


def test_options_reach_the_heuristic(run, refused):
    run("run", "tracking", "--heuristic", "lp-rounding", "--option", "ties=first", "--steps", 1, *SMALL, code=0)
    assert "ties" in refused("run", "tracking", "--heuristic", "lp-rounding", "--option", "ties=none", "--steps", 1, "-q", *SMALL)


@pytest.mark.share(2)
@pytest.mark.parametrize("suffix", ["gif", "html"])
def test_an_animation_is_written(run, tmp_path, suffix):
    path = tmp_path / f"film.{suffix}"
    run("run", "tracking", "--policy", "stay", "--steps", 2, *SMALL, "--animation", path, code=0)
    assert path.read_bytes()[:3] == (b"GIF" if suffix == "gif" else b"\n<l")
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (
            ("mars",),
            "choose from explore-map-search, fire-monitoring, fleet-energy, hotspot-identification, information-gathering, orchard",
        ),
        (("tracking", "--policy", "nothing"), "choose from force-vector, stay"),
        (("tracking", "--policy", "stay", "--solver", "highs"), "one of solver, heuristic and policy"),
        (("tracking", "--steps", "0"), "steps must be"),
        (("tracking", "--seed", "-1"), "seed"),
        (("tracking", "--set", "colour=red"), "it takes scenario"),
        (("tracking", "--set", "seed=3"), "no setting 'seed'"),
        (("tracking", "--set", "robots=0"), "robots must lie between"),
        (("tracking", "--set", "robots"), "KEY=VALUE"),
        (("tracking", "--solver", "nothing"), "unknown solver"),
        (("tracking", "--heuristic", "savings"), "savings cannot take this problem"),
        (("tracking", "--heuristic", "savings"), "policies of tracking: force-vector, stay"),
        (("information-gathering", "--heuristic", "auction"), "auction is a policy: --policy auction"),
        (("tracking", "--time-limit", "nan"), "finite"),
        (("tracking", "--out", "log.txt"), "suffix"),
        (("tracking", "--out", "missing/log.csv"), "no folder"),
        (("tracking", "--animation", "film.mp4"), "suffix"),
        (("tracking", "--animation", "missing/film.gif"), "no folder"),
    ],
)
def test_what_cannot_be_run_is_refused_in_one_line_and_nothing_is_written(refused, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    assert says in refused("run", *arguments, "-q")
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_writes_the_steps_so_far_and_is_exit_0(run, tmp_path, monkeypatch):
    real, calls = Tracking.measures, []

    def interrupting(self, decisions, world):
        calls.append(1)
        if len(calls) == 3:
            os.kill(os.getpid(), signal.SIGINT)
        return real(self, decisions, world)

    monkeypatch.setattr(Tracking, "measures", interrupting)
    path = tmp_path / "log.csv"
    result = run("run", "tracking", "--heuristic", "greedy", "--steps", 50, *SMALL, "--out", path, "-q", code=0)
    assert "interrupted after 2 of 50 steps" in result.stderr
    assert len(pd.read_csv(path)) == 2


def test_an_interrupt_before_the_first_step_is_exit_130_and_writes_nothing(refused, tmp_path, monkeypatch):
    monkeypatch.setattr(Tracking, "teams", lambda self, observation: os.kill(os.getpid(), signal.SIGINT) or [observation])
    told = refused("run", "tracking", "--heuristic", "greedy", "--out", tmp_path / "log.csv", "-q", code=130)
    assert "interrupted" in told
    assert list(tmp_path.iterdir()) == []


def test_two_methods_are_filmed_side_by_side(run, tmp_path):
    common = ("--steps", 2, "--set", "robots=2", "--set", "targets=3", "--animation", tmp_path / "a.gif")
    run("run", "tracking", "--policy", "stay", "--against", "policy:force-vector", *common, code=0)
    assert (tmp_path / "a.gif").read_bytes().startswith(b"GIF")


@pytest.mark.slow
def test_days_of_different_lengths_are_filmed_side_by_side_to_their_ends(run, tmp_path):
    from PIL import Image

    settings = [text for setting in ("rows=2", "columns=4", "robots=1", "groups=2", "fill=3", "pickers=3") for text in ("--set", setting)]
    lengths = []
    for policy in ("greedy", "auction"):
        result = run("run", "orchard", "--policy", policy, *settings, "--json", "-q")
        lengths.append(json.loads(result.stdout)["steps"])
    assert lengths[0] != lengths[1]
    result = run(
        "run", "orchard", "--policy", "greedy", "--against", "policy:auction", *settings, "--animation", tmp_path / "a.gif", code=0
    )
    with Image.open(tmp_path / "a.gif") as film:
        assert film.n_frames == max(lengths) + 1


def test_a_second_method_needs_a_kind_and_a_film(refused, tmp_path):
    assert "give a file with --animation" in refused("run", "tracking", "--policy", "stay", "--against", "policy:stay")
    assert "solver:NAME" in refused("run", "tracking", "--policy", "stay", "--against", "stay", "--animation", tmp_path / "a.gif")
