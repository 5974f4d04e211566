from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from small_routing import plane

from waybound.formulations.programs.names import LONGEST, own_names, readable_names
from waybound.formulations.programs.program import Program, Rows, Variables


def block(name: str, size: int = 1, keys: tuple[Any, ...] = (), labels: tuple[Any, ...] = ()) -> Variables:
    free = np.zeros(size)
    return Variables(name, tuple(np.asarray(k) for k in keys), labels, lower=free, upper=free, cost=free)


def one_by_one(*blocks: Variables) -> list[str]:
    """What each entry is called by itself."""
    program = Program("test", "min", blocks, ())
    return [program.variable_name(k) for k in range(program.num_variables)]


def test_names_are_different_and_valid_whatever_the_sites_are_called() -> None:
    given_names = ["x[a,b]", "x[a b]", "x[a-b]", "e5", "E", "free", "3rd", "infinity1", "", "x" * 300, "x" * 300, "ü[1]", "time-link[1,2]"]
    names = readable_names([block(name) for name in given_names], "x")
    assert len(set(names)) == len(names)
    assert names[0] == "x(a,b)" and names[-1] == "time_link(1,2)"
    assert all(name.isascii() and " " not in name and "[" not in name for name in names)
    assert names[3] == "x_e5" and names[5] == "x_free" and names[6] == "x_3rd"


TEXT = st.text(st.sampled_from("ab[](),.- ü3eE_"), max_size=4)
LABELS = st.lists(TEXT | st.just("y" * 250), min_size=3, max_size=3)


@given(
    st.lists(st.tuples(TEXT | st.sampled_from(["x", "inf", "free", "e"]), st.none() | LABELS, st.none() | LABELS), min_size=1, max_size=4)
)
@settings(deadline=None, max_examples=150)
def test_names_of_a_block_at_once_are_those_of_its_entries(parts: list[tuple[str, list[str] | None, list[str] | None]]) -> None:
    blocks = [block(name, 4, ([0, 1, 2, 1], [2, 2, 0, 1]), (first, second)) for name, first, second in parts]
    blocks += [block("alone"), block("many", 3), block("none", 0)]
    assert own_names(blocks) == one_by_one(*blocks)
    together, singly = readable_names(blocks, "x"), readable_names([block(name) for name in one_by_one(*blocks)], "x")
    assert together == singly and len(set(together)) == len(together) and max(map(len, together)) <= LONGEST + 20


@pytest.mark.parametrize("form", ["three-index", "two-index-time-flow", "set-partitioning"])
def test_names_of_forms_are_those_of_their_entries(form: str) -> None:
    program = plane(1, 5, 20.0, 2).compile(form).program
    rows = [program.row_name(k) for k in range(program.num_rows)]
    assert own_names(program.rows) == rows and own_names(program.variables) == one_by_one(*program.variables)
    assert readable_names(program.rows, "r") == readable_names([Rows(name, lower=np.zeros(1), upper=np.zeros(1)) for name in rows], "r")


def test_a_label_is_asked_for_once_whatever_the_number_of_entries() -> None:
    asked: list[int] = []

    class Labels:
        def __len__(self) -> int:
            return 2

        def __getitem__(self, k: int) -> str:
            asked.append(k)
            return "ab"[k]

    assert readable_names([block("x", 1000, (np.arange(1000) % 2, np.arange(1000)), (Labels(), None))], "x")[-1] == "x(b,999)"
    assert sorted(asked) == [0, 1]
