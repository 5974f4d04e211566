"""Campaign files: what they plan, and what they must not say."""

import re
from pathlib import Path
from typing import Any

import pytest
from campaign_cases import campaign_file
from coded import coded

from waybound.instances.errors import Code, MissingPackageError, WayboundError
from waybound.reports.campaigns.campaign import bundled_campaigns, read_campaign
from waybound.solvers.backend import BACKENDS


def test_every_instance_meets_every_method_and_seed_once(tmp_path: Path) -> None:
    asked = campaign_file(tmp_path, instances=["demo-tiny", "demo-c25", "demo-t*"], solvers=["highs"], seeds=[3, 5])
    (tmp_path / "demo-tall.txt").write_text("x")
    made = read_campaign(asked)
    assert made.results == tmp_path / "r.sqlite" and made.folder == tmp_path
    assert len({run.key for run in made.runs}) == len(made.runs) == 3 * 2 * 2
    assert [(run.seed, run.instance.name, run.setting.label) for run in made.runs[:3]] == [
        (3, "demo-tiny", "highs"), (3, "demo-tiny", "savings"), (3, "demo-c25", "highs"),
    ]  # fmt: skip


def test_the_least_is_enough_and_one_seed_is_the_default(tmp_path: Path) -> None:
    (run,) = read_campaign(campaign_file(tmp_path, without="seeds")).runs
    assert run.seed == 1 and run.setting.time_limit == 60 and run.setting.bound_time == 0


def test_options_and_grids_of_a_method_are_combined_and_tables_say_more(tmp_path: Path) -> None:
    asked = campaign_file(
        tmp_path, heuristics=["savings"], seeds=[1], convention=["exact", "trunc1"], problem="vrptw",
        solvers=[{"name": "highs", "form": ["two-index-mtz", "circuit"], "time_limit": 7, "options": {"presolve": "off"}}],
        options={"highs": {"threads": 2}}, grid={"highs": {"mip_rel_gap": [0.1, 0.2]}},
    )  # fmt: skip
    settings = [run.setting for run in read_campaign(asked).runs]
    of_highs = [s for s in settings if s.method == "highs"]
    assert len(of_highs) == 8 and len(settings) == 10
    assert {s.form for s in of_highs} == {"two-index-mtz", "circuit"} and {s.time_limit for s in of_highs} == {7}
    assert {tuple(sorted(s.options.items())) for s in of_highs} == {
        (("mip_rel_gap", gap), ("presolve", "off"), ("threads", 2)) for gap in (0.1, 0.2)
    }
    assert {s.convention for s in settings} == {"exact", "trunc1"} and {s.problem for s in settings} == {"vrptw"}


def test_an_instance_may_be_read_in_its_own_way(tmp_path: Path) -> None:
    entries = ["demo-c25", {"file": "demo-r25", "convention": "trunc1", "set": {"vehicles": "unlimited"}}]
    first, second = read_campaign(campaign_file(tmp_path, instances=entries, seeds=[1], set={"capacity": 50})).runs
    assert first.setting.changes == {"capacity": 50} and first.setting.convention is None
    assert second.setting.changes == {"capacity": 50, "vehicles": "unlimited"} and second.setting.convention == "trunc1"


def test_instances_may_lie_in_a_folder_that_a_variable_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for place in ("here", "there"):
        (tmp_path / "files" / place).mkdir(parents=True)
        for name in ("a.txt", "b.txt"):
            (tmp_path / "files" / place / name).write_text(place + name)
    monkeypatch.setenv("FILES_OF_A_TEST", str(tmp_path / "files"))
    entries = ["here/a.txt", {"folder": "$FILES_OF_A_TEST/there", "file": ["a.txt", "b*"], "convention": "trunc1"}, "demo-tiny"]
    made = read_campaign(campaign_file(tmp_path, folder="$FILES_OF_A_TEST", instances=entries, seeds=[1], results="$FILES_OF_A_TEST/r"))
    assert [run.instance.file for run in made.runs] == ["here/a.txt", "a.txt", "b.txt", "demo-tiny"]
    assert [run.setting.convention for run in made.runs] == [None, "trunc1", "trunc1", None]
    assert made.results == tmp_path / "files" / "r" and made.folder == tmp_path


def test_instances_may_be_generated_once_and_are_files_beside_the_results(tmp_path: Path) -> None:
    entry = {"generate": "random", "seeds": [1, 4], "set": {"customers": 5}, "convention": "exact"}
    asked = campaign_file(tmp_path, instances=[entry, {**entry, "set": {"customers": 6}}], seeds=[1], set={"vehicles": 3})
    first = read_campaign(asked)
    assert [run.instance.name for run in first.runs] == 2 * ["random-1", "random-4"]
    assert len({run.instance.hash for run in first.runs}) == 4 and {run.setting.convention for run in first.runs} == {"exact"}
    assert all(run.setting.changes == {"vehicles": 3} for run in first.runs), "settings of a generator are no changes of the data"
    paths = [run.instance.path for run in first.runs]
    assert all(path.is_relative_to(tmp_path / "r.instances") for path in paths) and paths[0].parent != paths[2].parent
    written = [path.stat().st_mtime_ns for path in paths]
    assert [run.key for run in read_campaign(asked).runs] == [run.key for run in first.runs]
    assert written == [path.stat().st_mtime_ns for path in paths]


def test_values_of_a_table_are_of_files_as_they_stand_or_as_the_campaign_says(tmp_path: Path) -> None:
    (tmp_path / "own.csv").write_text("instance,value\ndemo-tiny,7\n")
    ways: list[dict[str, Any]] = [
        {"convention": "trunc1"}, {"set": {"customers": 3}}, {"set": {"vehicles": 9}, "best_known": True}, {"best_known": False},
        {"problem": "tsp", "best_known": 5}, {"problem": "cvrp"},
    ]  # fmt: skip
    asked = campaign_file(tmp_path, instances=[{"file": "demo-tiny", **way} for way in ways], best_known="own.csv", seeds=[1])
    made = read_campaign(asked)
    known = made.best_known_values()
    values = [[value for *_, value in known[run.instance.hash, run.setting.reading]] for run in made.runs]
    assert values == [[7.0], [], [7.0], [], [5.0], []]


@pytest.mark.parametrize(
    ("changes", "code", "told"),
    [
        ({"solver": ["highs"]}, "unknown-name", "did you mean 'solvers'"),
        ({"solvers": ["highss"]}, "unknown-name", "did you mean 'highs'"),
        ({"heuristics": ["saving"]}, "unknown-name", "did you mean 'savings'"),
        ({"heuristics": []}, "missing", "names no method"),
        ({"instances": []}, "missing", "names no instance"),
        ({"instances": ["gone.txt"]}, "missing", "no such file"),
        ({"instances": [{"problem": "tsp"}]}, "missing", "no key 'file'"),
        ({"instances": [{"generate": "randon"}]}, "unknown-name", "c.toml: unknown .*did you mean 'random'"),
        ({"instances": [{"generate": "random", "set": {"customer": 5}}]}, "unknown-name", "did you mean 'customers'"),
        ({"instances": [{"generate": "random", "file": "demo-tiny"}]}, "missing", "both 'file' and 'generate'"),
        ({"instances": ["$NO_SUCH_VARIABLE/a.txt"]}, "missing", "needs the environment variable NO_SUCH_VARIABLE, which is not set"),
        ({"instances": [{"file": "demo-tiny", "best_known": "5"}]}, "malformed", "a value, or true or false"),
        ({"solvers": [{"form": "circuit"}]}, "missing", "no key 'name'"),
        ({"heuristics": [{"name": "savings", "form": "circuit"}]}, "unknown-name", "unknown key 'form' of a heuristic"),
        ({"solvers": [{"name": "highs", "form": "circuits"}]}, "unknown-name", "did you mean 'circuit'"),
        ({"problem": "vrpt"}, "unknown-name", "vrpt"),
        ({"time_limit": -1}, "out-of-range", "time_limit must be positive"),
        ({"time_limit": "1"}, "out-of-range", "time_limit"),
        ({"overtime": -1}, "out-of-range", "overtime"),
        ({"seeds": [-1]}, "out-of-range", "a seed must be"),
        ({"options": {"savings": {"hh": 1}}}, "unknown-name", "savings has no option 'hh'"),
        ({"options": {"saving": {}}}, "unknown-name", "no method of this campaign; did you mean 'savings'"),
        ({"grid": {"savings": {"h": 1}}}, "malformed", "h of the grid of savings must be a list"),
        ({"results": ["r"]}, "malformed", "expected a text"),
    ],
)  # fmt: skip
def test_what_a_campaign_must_not_say_is_one_error(tmp_path: Path, changes: dict[str, Any], code: Code, told: str) -> None:
    with pytest.raises(WayboundError, match=told, check=coded(code)) as fault:
        read_campaign(campaign_file(tmp_path, **changes))
    assert fault.value.exit_code == 2 and "\n" not in str(fault.value)
    assert not (tmp_path / "r.sqlite").exists()


def test_the_file_on_the_page_is_one(tmp_path: Path) -> None:
    page = Path(__file__).resolve().parents[3] / "docs" / "campaigns.md"
    (text,) = re.findall(r"^```toml\n(.*?)^```$", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    for folder, file in (("solomon", "r.txt"), ("own", "depot.json")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / file).touch()
    (tmp_path / "c.toml").write_text(text)
    runs = read_campaign(tmp_path / "c.toml").runs
    assert len(runs) == 2 * (1 + 2 + 3) * 5 and {run.setting.convention for run in runs} == {"exact", "trunc1"}


@pytest.mark.parametrize("key", ["results", "instances"])
def test_what_is_needed_must_be_there(tmp_path: Path, key: str) -> None:
    with pytest.raises(WayboundError, match=f"the key '{key}' is missing", check=coded("missing")):
        read_campaign(campaign_file(tmp_path, without=key))


def test_bad_syntax_is_told_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "c.toml").write_text("results = 'r'\ninstances = [\nx")
    with pytest.raises(WayboundError, match=r"c.toml:3: is no TOML", check=coded("malformed")):
        read_campaign(tmp_path / "c.toml")
    with pytest.raises(WayboundError, match="no such file", check=coded("file")):
        read_campaign(tmp_path / "gone.toml")


def test_a_solver_that_is_not_installed_is_told_before_anything_is_run(tmp_path: Path, registered: Any) -> None:
    class Gone(BACKENDS["highs"]):  # type: ignore[misc]
        name, modules, package = "gone", ("no_such_module",), "no-such-package"

    registered(BACKENDS, "gone", Gone)
    with pytest.raises(MissingPackageError, match="pip install no-such-package"):
        read_campaign(campaign_file(tmp_path, solvers=["gone"]))


def test_every_bundled_campaign_can_be_read_and_puts_its_results_where_the_user_is(tmp_path: Path) -> None:
    assert "demo-campaign" in bundled_campaigns()
    for name, file in bundled_campaigns().items():
        campaign = read_campaign(file, tmp_path)
        assert campaign.results == tmp_path / f"{name}.sqlite" and 10 < len(campaign.runs) < 100
