import math
from pathlib import Path

import pytest
from coded import coded
from file_cases import check_refused

from waybound import GeneralisedAssignmentInstance, InputError, UsageError
from waybound.instances.auctions.formats.agent_jobs import read, recognises, write

TEXT = """# name: yard
agent,job,cost,consumption,capacity
lift,,,,5
crane,,,,7.5
lift,a,3,2,
crane,a,1,2.5,
crane,b,4,5,
"""


def test_a_text_becomes_an_instance_and_the_same_text_again() -> None:
    made = read(TEXT, Path("x.csv"))
    assert recognises(TEXT) and made.name == "yard" and made.objective == "cost"
    assert made.agent_names == ("lift", "crane") and made.job_names == ("a", "b") and made.capacity.tolist() == [5.0, 7.5]
    assert made.values.tolist() == [[3.0, math.inf], [1.0, 4.0]] and made.consumption.tolist() == [[2.0, 0.0], [2.5, 5.0]]
    assert write(made) == TEXT


def test_profits_are_told_by_their_title() -> None:
    assert read(TEXT.replace("cost", "profit"), Path("x.csv")).objective == "profit"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("crane,,,,7.5\n", "", "line 5: the agent has no capacity"),
        ("lift,a,3,2,", "lift,a,3,2,9", "line 5: a row is that of a capacity or of a job"),
        ("lift,,,,5", "lift,,1,,5", "line 3: a capacity stands alone"),
        ("lift,,,,5", "lift,,,,nan", "line 3"),
        ("lift,a,3,2,", "lift,a,,2,", "line 5"),
        ("crane,b,4,5,", "crane,a,4,5,", "line 7: the pair stands twice, first in line 6"),
        ("crane,,,,7.5", "lift,,,,7.5", "line 4: agent .lift. has two capacities"),
        ("lift,a,3,2,", ",a,3,2,", "line 5: agent must have a name"),
        (",cost,", ",capacity,", "line 2"),
        ("lift,a,3,2,\ncrane,a,1,2.5,\ncrane,b,4,5,\n", "", "holds no pairs"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(old: str, new: str, message: str) -> None:
    check_refused(InputError, message, read, TEXT.replace(old, new), Path("x.csv"))


def test_what_a_table_has_no_place_for_is_refused() -> None:
    check_refused(UsageError, "a job has no agent", write, GeneralisedAssignmentInstance([[1.0, math.inf]], [[1.0, 1.0]], [1.0]))
    with pytest.raises(UsageError, check=coded("unsupported")):
        write(object())
