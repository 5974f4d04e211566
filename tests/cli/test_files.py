"""``waybound export, convert, generate``."""

import json

import pytest

import waybound as wb


@pytest.mark.parametrize("suffix", [".mps", ".lp"])
def test_export_writes_a_program_that_highs_reads_back(run, tmp_path, suffix):
    import highspy

    path = tmp_path / f"model{suffix}"
    result = run("export", "demo-tiny", "--form", "two-index-mtz", "--to", path, code=0)
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
    run("convert", "demo-c25", "--to", tmp_path / "c.json", code=0)
    before, after = wb.read("demo-c25", convention="trunc1"), wb.read(tmp_path / "c.json", convention="trunc1")
    answer = wb.Routes.of([[1, 2, 3], [4, 5]])
    assert before.evaluate(answer) == after.evaluate(answer)


def test_conversion_takes_the_settings_that_solve_takes(run, refused, tmp_path):
    made = tmp_path / "c.json"
    run("convert", "demo-c25", "--to", made, "--set", "customers=5", "--set", "vehicles=2", "--convention", "trunc1", code=0)
    asked = wb.read("demo-c25", customers=5, vehicles=2, convention="trunc1")
    assert wb.read(made).digest() == asked.digest()
    sites = tmp_path / "s.csv"
    sites.write_text("id,lat,lon,service\no,45.8,16.0,0\na,45.9,16.1,5\nb,46.0,15.9,5\n")
    options = ("--set", "speed=30", "--set", "time-unit=min", "--objective", "vehicles then total-cost")
    run("convert", sites, "--to", made, *options, code=0)
    assert wb.read(made).digest() == wb.read(sites, speed=30, time_unit="min", objective="vehicles then total-cost").digest()
    assert "unknown setting vehicle; " in refused("convert", "demo-c25", "--to", made, "--set", "vehicle=2")


def test_tables_beside_a_csv_of_sites_say_what_python_says_with_lists(run, refused, tmp_path):
    files = {
        "s.csv": "id,x,y,demand\no,0,0,\na,3,0,1\nb,0,4,1\n7,3,4,\n8,6,8,\n", "w.csv": "site,ready,due\na,0,4\na,9,20\n",
        "p.csv": "pickup,delivery,load\na,b,2\n", "g.csv": "group,site,required\nfar,7,false\nfar,8,\n",
    }  # fmt: skip
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    beside = [
        part for key, name in (("windows", "w"), ("shipments", "p"), ("groups", "g")) for part in ("--set", f"{key}={tmp_path}/{name}.csv")
    ]
    run("convert", tmp_path / "s.csv", *beside, "--to", tmp_path / "made.json", code=0)
    asked = wb.read(
        tmp_path / "s.csv", windows={"a": [(0, 4), (9, 20)]}, shipments=[("a", "b", 2)], groups=[{"sites": ["7", "8"], "required": False}]
    )
    assert wb.read(tmp_path / "made.json").digest() == asked.digest()
    assert {"several-windows", "shipments", "groups"} <= asked.features()
    assert "unknown setting window; " in (told := refused("info", tmp_path / "s.csv", "--set", "window=w.csv"))
    assert "did you mean 'windows'?" in told
    (tmp_path / "p.csv").write_text("pickup,delivery\na,bb\n")
    assert "shipments name the unknown site 'bb'; expected the id of a site" in refused("info", tmp_path / "s.csv", *beside)


@pytest.mark.parametrize(
    ("key", "text", "told"),
    [
        ("shipments", "pickup,delivery\na,b\na,zz\n", "3: shipments name the unknown site 'zz'"),
        ("shipments", "\npickup,load\na,1\n", "2: shipments have no column 'delivery'"),
        ("groups", "group,site\n1,a\n\n1,zz\n", "4: groups name the unknown site 'zz'"),
        ("windows", "site,ready,due\na,0,4\nb,0,9\na,3,9\n", "4: windows of a are not apart from each other"),
        ("fleet", "name,wheels\nvan,4\n", "1: the fleet has an unknown column 'wheels'"),
        ("fleet", "name,start\nvan,o\ncar,zz\n", "3: fleet[1].start"),
    ],
)
def test_a_fault_inside_a_table_is_told_with_its_file_and_line(refused, tmp_path, key, text, told):
    (tmp_path / "beside.csv").write_text(text)
    (tmp_path / "s.csv").write_text(f"# {key}: beside.csv\nid,x,y\no,0,0\na,3,0\nb,0,4\n")
    assert f"error: {tmp_path / 'beside.csv'}:{told}" in refused("info", tmp_path / "s.csv")
    (tmp_path / "beside.csv").unlink()
    assert f"{tmp_path / 's.csv'}:1: {key} 'beside.csv' no such file" in refused("info", tmp_path / "s.csv")


def test_conversion_names_what_a_format_cannot_express(run, refused, tmp_path):
    path, target = tmp_path / "least.json", tmp_path / "least.txt"
    run("convert", "demo-tiny", "--to", path, code=0)
    path.write_text(json.dumps({**json.loads(path.read_text()), "min_vehicles": 2}))
    told = refused("convert", path, "--to", target, "--to-format", "solomon")
    assert "no place for" in told
    assert "min-vehicles" in told
    assert not target.exists()


def test_conversion_does_not_overwrite_its_input(run, refused, tmp_path):
    path = tmp_path / "c.json"
    run("convert", "demo-tiny", "--to", path, code=0)
    kept = path.read_bytes()
    assert "overwrite the input" in refused("convert", path, "--to", path)
    assert path.read_bytes() == kept


@pytest.mark.parametrize("setting", [True, False], ids=["set", "comment"])
def test_nothing_overwrites_a_table_beside_the_input(refused, tmp_path, setting):
    sites, pairs = tmp_path / "s.csv", tmp_path / "p.csv"
    sites.write_text(f"{'' if setting else '# shipments: p.csv'}\nid,x,y\no,0,0\na,3,0\nb,0,4\n")
    pairs.write_text("pickup,delivery\na,b\n")
    asked = ("--set", f"shipments={pairs}") if setting else ()
    for command, option in (("convert", "--to"), ("solve", "--out"), ("solve", "--log")):
        assert "would overwrite the input" in refused(command, sites, *asked, option, pairs)
    assert pairs.read_text() == "pickup,delivery\na,b\n"


def test_generation_repeats_itself_from_the_seed(run, tmp_path):
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        run("generate", "random", "--set", "customers=6", "--set", "name=x", "--seed", seed, "--out", tmp_path / f"{name}.json", code=0)
    a, b, c = ((tmp_path / f"{name}.json").read_text() for name in "abc")
    assert a == b != c
    made = wb.read(tmp_path / "a.json")
    assert isinstance(made, wb.RoutingProblem)
    assert len(made.customers) == 6


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("nonsense",), "choose from"), (("random", "--set", "colour=red"), "colour"), (("random", "--set", "customers=-1"), "customers"),
        (("random", "--set", "seed=1"), "--seed"), (("random", "--seed", "-1"), "seed"),
    ],
)  # fmt: skip
def test_generation_refuses_what_it_does_not_know(refused, tmp_path, arguments, says):
    assert says in refused("generate", *arguments, "--out", tmp_path / "a.json")
    assert list(tmp_path.iterdir()) == []


LONG = "n" * 300


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("info", LONG), "File name too long"),
        (("info", f"{LONG}.csv"), "File name too long"),
        (("solve", LONG, "--time-limit", "1"), "File name too long"),
        (("convert", "demo-tiny", "--to", f"{LONG}.json"), "File name too long"),
        (("info", "s.csv", "--set", f"fleet={LONG}"), "File name too long"),
        (("info", "s.csv", "--set", f"matrix={LONG}"), "File name too long"),
        (("ratio", "bottleneck", "--instances", "1", "--out", LONG), "File name too long"),
    ],
)
def test_a_name_of_300_characters_is_refused_in_a_line(refused, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.csv").write_text("id,x,y\nyard,0,0\na,1,1\n")
    assert says in refused(*arguments)


def test_sites_and_problems_may_have_long_names(run, tmp_path):
    (tmp_path / "s.csv").write_text(f"# name: {LONG}\nid,x,y\nyard,0,0\n{LONG},1,1\n")
    run("solve", tmp_path / "s.csv", "--bound-time", "0", "--iterations", "10", "--out", tmp_path / "s.sol", code=0)
