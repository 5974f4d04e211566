from file_cases import check_refused

from waybound.instances.errors import UsageError
from waybound.instances.generating import generate


def test_days_repeat_and_name_every_bin():
    first, again, other = (generate("orchard-day", seed, rows=3, columns=6, groups=3) for seed in (1, 1, 2))
    assert first.digest() == again.digest()
    assert first.digest() != other.digest() or first.digest() != generate("orchard-day", 3, rows=3, columns=6, groups=3).digest()
    assert sorted(first.bin_cells.tolist()) == first.grid.harvested.tolist()
    assert (first.standing.sum(), first.format) == (3, "generated")


def test_settings_out_of_range_are_refused():
    check_refused(UsageError, "9 groups do not fit into 8 harvest cells", generate, "orchard-day", 1, groups=9)
    check_refused(UsageError, "no setting 'pickers'", generate, "orchard-day", 1, pickers=4)
