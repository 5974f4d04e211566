import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import Here, campaign_file, outcome
from coded import coded
from killed_campaigns import ROWS

from waybound import UsageError, results
from waybound.instances.bundled import bundled_path
from waybound.reports.campaigns.campaign import read_campaign
from waybound.reports.campaigns.results_file import opened
from waybound.reports.campaigns.run_processes import RunProcesses
from waybound.reports.campaigns.running import run_campaign

TESTS = Path(__file__).resolve().parents[2]


def test_every_run_is_done_once_and_told(done: Any) -> None:
    assert done.count == 6 == len(done.told)
    assert [(k, of) for k, of, _ in done.told] == [(k + 1, 6) for k in range(6)]
    assert "demo-tiny by savings, seed 1" in {what for *_, what in done.told}
    assert run_campaign(done.campaign, RunProcesses()) == 0


def test_what_is_asked_for_later_is_all_that_is_done_then(tmp_path: Path) -> None:
    first, later = Here(lambda task: outcome(task.seed)), Here(lambda task: outcome(-1.0))
    assert run_campaign(read_campaign(campaign_file(tmp_path)), first) == 2
    assert run_campaign(read_campaign(campaign_file(tmp_path, seeds=[2, 3])), later) == 1
    assert results(tmp_path / "r.sqlite")["objective"].tolist() == [1.0, 2.0, -1.0]


def test_an_instance_that_changes_is_another_one(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    file.write_bytes(bundled_path("demo-tiny").read_bytes())
    asked = campaign_file(tmp_path, instances=["a.json"])
    assert run_campaign(read_campaign(asked), Here(lambda task: outcome())) == 2
    file.write_bytes(file.read_bytes() + b"\n")
    assert run_campaign(read_campaign(asked), Here(lambda task: outcome())) == 2


def test_runs_that_ended_in_an_error_are_done_again_only_if_asked(tmp_path: Path) -> None:
    asked = read_campaign(campaign_file(tmp_path))
    bad = Here(lambda task: outcome(None, status="error") if task.seed == 1 else outcome())
    assert run_campaign(asked, bad) == 2
    assert run_campaign(asked, Here()) == 0
    assert run_campaign(asked, Here(lambda task: outcome(5.0)), again=True) == 1
    assert results(asked.results)["status"].tolist() == ["feasible", "feasible"]


def test_a_setting_that_does_not_exist_is_told_before_anything_is_run(tmp_path: Path) -> None:
    workers = Here()
    changed: tuple[tuple[dict[str, Any], Any], ...] = (
        ({"convention": "exakt"}, "unknown-name"),
        ({"set": {"vehicels": 3}}, "unknown-name"),
    )
    for changes, code in changed:
        with pytest.raises(UsageError, match=r"exakt|vehicels", check=coded(code)):
            run_campaign(read_campaign(campaign_file(tmp_path, **changes)), workers)
    assert workers.done == 0


def test_an_instance_that_cannot_be_read_costs_its_runs_alone(tmp_path: Path) -> None:
    (tmp_path / "bad.txt").write_text("nonsense\n")
    asked = read_campaign(campaign_file(tmp_path, instances=["bad.txt", "demo-tiny"], seeds=[1]))
    assert run_campaign(asked, Here()) == 2
    frame = results(asked.results)
    assert frame["status"].tolist() == ["error", "feasible"] and "bad.txt" in frame["reason"][0]


def test_a_disk_that_runs_full_costs_nothing_of_what_is_there_and_the_campaign_goes_on_when_there_is_room(tmp_path: Path) -> None:
    script = f"mount -t tmpfs -o size=1500k none {tmp_path} && exec {sys.executable} {TESTS / 'full_disks.py'} {tmp_path}"
    try:
        ended = subprocess.run(["unshare", "-r", "-m", "sh", "-c", script], capture_output=True, text=True)
    except OSError:
        pytest.skip("there is no unshare to make a small disk with")
    if "unshare" in ended.stderr or "mount" in ended.stderr:
        pytest.skip(f"no small disk can be mounted: {ended.stderr.strip()}")
    assert ended.returncode == 0, ended.stderr
    first, there, second, still, third, last = ended.stdout.splitlines()
    assert first == second == f"{tmp_path}/r.sqlite: cannot be written: the disk is full; what was there is kept, and is not run again"
    assert 0 < int(there) <= int(still) < 20 and third == f"{20 - int(still)} done" and last == "20"


def test_an_instance_that_vanishes_while_the_campaign_runs_costs_its_runs_alone(tmp_path: Path) -> None:
    for name in ("a.json", "b.json"):
        (tmp_path / name).write_bytes(bundled_path("demo-tiny").read_bytes())
    asked = read_campaign(campaign_file(tmp_path, instances=["a.json", "b.json"], seeds=[1]))
    (tmp_path / "b.json").unlink()
    assert run_campaign(asked, Here()) == 2
    frame = results(asked.results)
    assert frame["status"].tolist() == ["feasible", "error"] and "b.json: no such file" in frame["reason"][1]


def killed(folder: Path, times: int, seed: int) -> list[str]:
    command = [sys.executable, str(TESTS / "killed_campaigns.py"), str(folder), str(times), str(seed)]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.split()


def test_campaigns_killed_at_random_instants_and_taken_up_again_are_as_if_undisturbed(tmp_path: Path) -> None:
    *there, verdict = killed(tmp_path, 5, 1)
    assert verdict == "equal"
    assert len(there) == 5 and sorted(map(int, there)) == [int(k) for k in there]


@pytest.mark.slow
def test_so_are_those_killed_twenty_times(tmp_path: Path) -> None:
    assert killed(tmp_path, 20, 2)[-1] == "equal"


@pytest.mark.slow
def test_the_command_is_killed_twenty_times_with_all_its_processes_and_ends_as_if_undisturbed(tmp_path: Path) -> None:
    keys: dict[str, Any] = {"seeds": list(range(1, 41)), "heuristics": ["savings"], "instances": ["demo-tiny"]}
    quiet = campaign_file(tmp_path, results="quiet.sqlite", **keys).rename(tmp_path / "quiet.toml")
    asked = campaign_file(tmp_path, results="killed.sqlite", **keys)
    command = [sys.executable, "-m", "waybound", "bench", "-q", "--json"]
    began = time.monotonic()
    told = json.loads(subprocess.run([*command, str(quiet)], capture_output=True, check=True).stdout)
    took, draw = time.monotonic() - began, random.Random(3)
    assert told["ran"] == 40
    for _ in range(20):
        process = subprocess.Popen([*command, str(asked)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            process.wait(draw.uniform(0.2, 0.8) * took)
            break  # it came to its end
        except subprocess.TimeoutExpired:
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
    subprocess.run([*command, str(asked)], capture_output=True, check=True)
    with opened(tmp_path / "quiet.sqlite") as one, opened(tmp_path / "killed.sqlite") as other:
        rows = [connection.execute(ROWS.replace("d.solution, d.history", "r.status")).fetchall() for connection in (one, other)]
    assert rows[0] == rows[1] and len(rows[0]) == 40
