import pytest
from file_cases import refused

from waybound.instances.risk.formats._settings import elements_of, graph_settings, numbers_of


def of(**given):
    return {key: (k, value) for k, (key, value) in enumerate(given.items(), start=1)}


def test_elements_by_a_few_numbers_each():
    made = elements_of(of(length="0.1 linear", turn="0.02", travelled="0.1 3", tether="0 0 0.01 0.03"), [], 0.5)
    assert [element.kind for element in made] == ["length", "turn", "travelled", "tether"]
    assert (made[0].growth, made[1].measure, made[2].free, made[3].tether.spacing) == ("linear", "angle", 3.0, 0.5)


def test_what_a_graph_is_told():
    told = graph_settings(of(conditional="No", objective="hazard", discount="0.5"))
    assert told == {"conditional": False, "objective": "hazard", "discount": 0.5}


@pytest.mark.parametrize(
    ("read", "message"),
    [
        (lambda: graph_settings({}), "line 1: it must be said whether risks are conditional; expected a line '# conditional: yes', or no"),
        (lambda: graph_settings(of(conditional="perhaps")), "line 1: conditional must be yes or no; found 'perhaps'"),
        (lambda: graph_settings(of(conditional="yes", objective="luck")), "line 2: the objective is unknown"),
        (lambda: numbers_of(of(turn="0.1 0.2"), "turn", 1, 1), "line 1: turn needs 1 numbers; found '0.1 0.2'"),
        (lambda: numbers_of(of(turn="0.1 x"), "turn", 1, 1), "line 1: turn needs 1 numbers; found 'x'"),
        (lambda: elements_of(of(turn="0.1 square"), [], None), "line 1: turn has an unknown word 'square'; expected norm, angle, change"),
        (lambda: elements_of(of(length="-1"), [], None), "line 1: the rate of length must be a number of at least 0"),
    ],
)
def test_complaints_name_the_line(read, message):
    assert message in refused(read)
