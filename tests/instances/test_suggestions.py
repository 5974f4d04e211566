import pytest

from waybound.instances.suggestions import did_you_mean, nearest

KNOWN = ("demand", "ready", "due", "max_duration")


@pytest.mark.parametrize(
    ("name", "meant"), [("dmand", "demand"), ("DEMANDS", "demand"), ("max-duration", "max_duration"), ("phone", None), ("", None)]
)
def test_the_nearest_name_is_found_whatever_its_case(name: str, meant: str | None) -> None:
    assert nearest(name, KNOWN) == meant
    assert did_you_mean(name, KNOWN) == ("" if meant is None else f"; did you mean {meant!r}?")
