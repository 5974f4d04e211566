import json
from pathlib import Path

import pytest
from file_cases import refused
from risk_problems import STALLING, around_a_box, changed, problem

from waybound import RiskAllocation, RiskAllocationInstance
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.risk.allocation_files import decode, encode
from waybound.instances.writing import write_instance


def everything() -> RiskAllocation:
    return problem(
        cost__terms=[{"kind": "square", "weight": 2, "decisions": [[1, 0]], "constant": [3]}, {"kind": "norm", "quantities": [[1, 1]]}],
        cones=[{"decisions": [[1, 0], [0, 1]], "limit": {"decisions": [0, 1], "constant": 4}}, {"decisions": [[1, 1]], "limit": 9}],
        risk__budgets=[{"name": "one", "constraints": ["2"], "risk": 0.03}], constraints__names=["sum"], notes=["told"],
    )  # fmt: skip


@pytest.mark.parametrize("made", [problem(), everything(), around_a_box()], ids=lambda p: p.name)
def test_what_is_written_is_read_again(made: RiskAllocation) -> None:
    data = json.loads(json.dumps(encode(made.instance)))
    again = decode(data)
    assert again.digest() == made.digest()
    assert encode(again) == data
    assert again.notes == made.notes


def test_dynamics_are_written_as_they_are(tmp_path: Path) -> None:
    made = generate("risk-allocation", 3, family="corridor", steps=4)
    write_instance(made, tmp_path / "c.json")
    again = read_instance(tmp_path / "c.json")
    assert isinstance(made, RiskAllocationInstance) and isinstance(again, RiskAllocationInstance)
    assert again.digest() == made.digest()
    assert "quantities" not in json.loads((tmp_path / "c.json").read_text())
    assert again.decision_names[:2] == ("ux@1", "uy@1")


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (changed(quantities=None), "either quantities or dynamics"),
        (changed(decisions=None), "lacks the key 'decisions'"),
        (changed(speed=3), "unknown key 'speed'"),
        (changed(chance__limits=[5]), "chance.limits has a wrong length"),
        (changed(chance__decisions=[[1, 0]]), "another number of rows over decisions than over quantities"),
        (changed(chance__constraint=[0, 7]), "each of these has a row"),
        (changed(quantities__map=[[1, 0], [0]]), "quantities.map[1] has a wrong length"),
        (changed(quantities__map={"rows": 1, "row": [0], "column": [5], "value": [1]}), "quantities.map.column[0] does not exist"),
        (changed(problem="vrptw"), "allow one problem"),
        (changed(upper="much"), "upper must be a list"),
    ],
)
def test_errors_name_the_key(data: dict, said: str) -> None:
    assert said in refused(decode, data)


def test_defaults_are_those_of_the_page() -> None:
    made = decode(STALLING)
    assert made.risk.each.tolist() == [0.1, 0.1]
    assert made.upper.tolist() == [float("inf")] * 2
    assert made.chance.names == ("1", "2")
