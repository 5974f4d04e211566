import json
from pathlib import Path
from typing import Any

import pytest
from file_cases import Refusal, check_fault, check_refused

from waybound.instances.errors import InputError, UsageError
from waybound.instances.formats.waybound_json import read, recognises, write
from waybound.instances.generating import generate
from waybound.instances.kinds import KINDS, Kind


def document(**changes: Any) -> str:
    data = json.loads(write(generate("random", 1)))
    data.update(changes)
    return json.dumps({key: value for key, value in data.items() if value != "drop"}, indent=1)


def test_the_version_stands_first() -> None:
    assert write(generate("random", 1)).startswith('{\n  "waybound": 1,\n  "kind": "routing",')


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"waybound": 2}, "schema version is not supported; expected 1; found 2"),
        ({"waybound": "1"}, "waybound must be a whole number"),
        ({"waybound": True}, "waybound must be a whole number"),
        ({"waybound": "drop"}, "is JSON, but no waybound instance"),
        ({"kind": "drop"}, "the document lacks the key 'kind'"),
        ({"kind": "sudoku"}, f"kind is unknown; expected {', '.join(KINDS.names())}"),
        ({"waybound": "drop", "answer": None}, "is a solution file, not an instance"),
        ({"colour": "red"}, "the document has an unknown key 'colour'"),
    ],
)
def test_a_document_of_another_sort_is_refused(changes: dict[str, Any], message: str, refusal: Refusal) -> None:
    assert message in str(refusal(document(**changes)))


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ('{\n"waybound": 1,\n', "is no JSON: Expecting property name", 3),
        ('{\n"waybound": 1,\n"waybound": 1}', "key 'waybound' stands twice", 2),
        ('{\n"waybound":\nNaN}', "JSON has no such number", 3),
        ('{"a": -Infinity}', "JSON has no such number", 1),
        ('{"a": 1} x', "Extra data", 1),
        ('{"a": ' + "[" * 100_000, "is nested too deeply", None),
        ('{"a": ' + "9" * 5000 + "}", "is JSON, but no waybound instance", None),
        ('{"a": ' + "[" * 60 + "]" * 60 + "}", "is nested too deeply", None),
    ],
)
def test_what_is_no_json_is_refused(text: str, message: str, line: int | None, refusal: Refusal) -> None:
    check_fault(refusal(text), message, line)


def test_an_unknown_convention_in_the_file_is_an_input_error(refusal: Refusal) -> None:
    assert "unknown convention 'half'" in refusal(document(convention="half")).message


def test_objects_alone_are_recognised() -> None:
    assert recognises(' \n{"a": 1}')
    assert not recognises("[1]")


def test_an_instance_of_a_kind_without_json_is_refused() -> None:
    class Other:
        kind = "sudoku"
        name = "s1"

    check_refused(UsageError, "s1 is of kind sudoku", write, Other())


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ([], "settings must be an object; found a list"),
        ({"risk": [1]}, "settings.risk must be a text, a number, true or false; found a list"),
    ],
)
def test_settings_of_a_saved_problem_are_plain_values(settings: Any, message: str, refusal: Refusal) -> None:
    assert message in str(refusal(document(settings=settings)))


def test_geojson_is_left_to_its_own_format() -> None:
    assert not recognises('{"type": "FeatureCollection", "features": []}')


@pytest.mark.parametrize("document", [{}, {"items": 3}, {"items": [{"size": "x"}]}])
def test_bad_data_of_a_kind_from_outside_are_told_in_one_line(document: dict[str, Any]) -> None:
    kind = Kind("boxes", lambda boxes: {}, lambda data: sum(item["size"] / 1 for item in data["items"]))
    with KINDS.temporary("boxes", kind), pytest.raises(InputError, match="is no document of kind boxes; found"):
        read(json.dumps({"waybound": 1, "kind": "boxes", **document}), Path("a.json"))
