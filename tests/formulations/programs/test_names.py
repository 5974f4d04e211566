"""Names that files and their readers agree on."""

from __future__ import annotations


def test_names_are_different_and_valid_whatever_the_sites_are_called() -> None:
    from waybound.formulations.programs.names import readable_names

    given_names = ["x[a,b]", "x[a b]", "x[a-b]", "e5", "E", "free", "3rd", "infinity1", "", "x" * 300, "x" * 300, "ü[1]", "time-link[1,2]"]
    made = readable_names(len(given_names), lambda k: given_names[k], "x")
    assert len(set(made)) == len(made)
    assert made[0] == "x(a,b)" and made[-1] == "time_link(1,2)"
    assert all(name.isascii() and " " not in name and "[" not in name for name in made)
    assert made[3] == "x_e5" and made[5] == "x_free" and made[6] == "x_3rd"
