from waybound.solvers.engines.routing.ruin_recreate_steps import columns as k


def test_flags_are_bits_of_their_own_below_the_number_of_windows() -> None:
    flags = (k.TIMED, k.SPANNED, k.PICKED, k.SHIPPED, k.GROUPED, k.RELOADING, k.WINDOWED, k.COUNTED, k.WALKED, k.CLOSING, k.RECHARGING)
    assert sum(flags) == (1 << len(flags)) - 1 < 1 << k.MANY


def test_what_a_row_ends_with_comes_after_all_named_columns() -> None:
    assert k.DEMAND == 11 and k.CAPACITY > k.HOME and k.ROOM > k.RELOADS and k.NODE_COLUMNS > k.CHOSEN
