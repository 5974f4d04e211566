import numpy as np
import pytest

from waybound.instances.errors import UsageError
from waybound.reports.battery.cases import Draw, cases


def test_the_same_draw_gives_the_same_cases_whatever_is_asked_of_it():
    every = list(cases(Draw(30, 4)))
    (again,) = cases(Draw(30, 4), range(17, 18))
    assert (again.kind, again.form, again.truth) == (every[17].kind, every[17].form, every[17].truth)
    assert (again.program.matrix != every[17].program.matrix).nnz == 0
    assert np.array_equal(again.program.cost, every[17].program.cost)


def test_a_form_is_drawn_from_the_kinds_that_have_it():
    chosen = list(cases(Draw(20, 1, form="two-index-mtz")))
    assert {c.form for c in chosen} == {c.program.name for c in chosen} == {"two-index-mtz"}
    assert {"time-windows", "fleets"} <= {c.kind for c in chosen}


@pytest.mark.parametrize(
    ("asked", "word"),
    [({"kind": "windows"}, "time-windows"), ({"form": "max-min", "kind": "time-windows"}, "max-min"), ({"form": "nope"}, "nope")],
)
def test_what_the_battery_does_not_have_is_refused_by_name(asked, word):
    with pytest.raises(UsageError, match=word):
        Draw(3, **asked)
