"""Random frames with columns under the names of other toolkits: each is refused with ours, or told as kept and not used; none is dropped
in silence, from a frame or from a file."""

import datetime
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import waybound as wb
from waybound.instances.errors import InputError
from waybound.instances.routing.foreign_names import ELSEWHERE, OURS, UNITS

SEED = 2905


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


OWN = _words("id x y lat lon demand pickup ready due service reward required penalty depot skills latitude longitude lng long")
"""Titles that count, in any case, written down here once more."""
PLAIN = (
    "colour", "address", "phone", "opening remarks", "Street", "zip", "comment", "e-mail", "zone", "km from town", "who", "Ä", "x2", "7",
)  # fmt: skip
"""Titles that nobody means anything by."""
FOREIGN = {table: [name for names in (*OURS[table].values(), *ELSEWHERE[table].values()) for name in names.split()] for table in OURS}
WORDS = sorted(UNITS - {"section", "m3"})

Rng = np.random.Generator


def spelt(rng: Rng, name: str) -> str:
    """``name`` as somebody might write it: spaces, capitals, one word, a unit behind it."""
    words = name.split("_")
    made = [
        "_".join(words), " ".join(words), "-".join(words), "".join(words), "".join(w.capitalize() for w in words), name.upper(),
        words[0] + "".join(w.capitalize() for w in words[1:]), " ".join(words).title(),
    ][int(rng.integers(8))]  # fmt: skip
    unit = WORDS[int(rng.integers(len(WORDS)))]
    return made + ["", "", "", f"_{unit}", f" [{unit}]", f" ({unit})", "."][int(rng.integers(7))]


def values(rng: Rng, n: int) -> list[Any]:
    """A column of something."""
    return [
        [float(v) for v in rng.integers(0, 99, n)], [int(v) for v in rng.integers(0, 2, n)], [bool(v) for v in rng.integers(0, 2, n)],
        ["a", "b", "c", "d", "e"][:n], [None] * n, [float("nan"), *(float(v) for v in rng.random(n - 1))],
        [datetime.datetime(2026, 5, 4, int(h)) for h in rng.integers(0, 24, n)], ["08:00"] * n, [[1, 2]] * n, [-1] * n,
    ][int(rng.integers(10))]  # fmt: skip


def frames(rng: Rng, count: int) -> Iterator[tuple[pd.DataFrame, list[str], list[str]]]:
    """Frames, with the titles of others that are in each, and those that say nothing."""
    for _ in range(count):
        n = int(rng.integers(2, 6))
        held: dict[str, Any] = {"x": rng.integers(0, 99, n).astype(float), "y": rng.integers(0, 99, n).astype(float)}
        if rng.random() < 0.3:
            held = {"lat": rng.uniform(40, 50, n), "lon": rng.uniform(0, 20, n)}
        for title in ("demand", "pickup", "service", "reward", "penalty"):
            if rng.random() < 0.15:
                held[title] = rng.integers(0, 5, n).astype(float)
        others = [spelt(rng, FOREIGN["sites"][int(k)]) for k in rng.integers(0, len(FOREIGN["sites"]), int(rng.integers(0, 3)))]
        plain = [PLAIN[int(k)] for k in rng.integers(0, len(PLAIN), int(rng.integers(0, 3)))]
        columns = {**{title: values(rng, n) for title in (*plain, *others)}, **held}
        titles = list(columns)
        rng.shuffle(titles)
        yield pd.DataFrame({title: pd.Series(columns[title], index=range(n)) for title in titles}), others, plain


def place(title: str) -> str:
    """What kind of place a title tells, if any: where the frame tells places of the other kind, it says nothing."""
    bare = "".join(c for c in title.casefold() if c.isalpha())
    for kind, marks in (("plane", ("xcoord", "ycoord", "coord", "posx", "posy", "easting", "northing")), ("globe", ("lat", "lon", "lng"))):
        if any(mark in bare for mark in marks):
            return kind
    return ""


def told(made: wb.RoutingProblem, title: str) -> bool:
    """Whether a remark on the problem names the column."""
    return any(f"{title}" in remark for remark in made.remarks() if remark.startswith("columns kept and not used: "))


def outcome(make: Callable[[], wb.RoutingProblem]) -> tuple[wb.RoutingProblem | None, str]:
    """The problem, or why there is none, in a line."""
    try:
        return make(), ""
    except InputError as fault:
        assert "\n" not in str(fault)
        return None, str(fault)


@pytest.mark.filterwarnings("ignore:latitude and longitude may be swapped")
def test_no_column_of_a_frame_or_file_is_dropped_in_silence(share: Callable[[int, int], int], tally: Any, tmp_path: Path) -> None:
    rng = np.random.default_rng(SEED)
    for number, (frame, others, plain) in enumerate(frames(rng, share(400, 10_000))):
        made, why = outcome(lambda frame=frame: wb.RoutingProblem.from_frame(frame, vehicles=2, speed=50.0, time_unit="min"))
        tally["frames with columns of other names"] += 1
        if made is None:
            tally["refused"] += 1
            assert others and any(title in why for title in others), (list(frame.columns), why)
        else:
            geographic = "lat" in frame.columns
            for title in others:
                counts = title.casefold() in OWN
                elsewhere = place(title) == ("plane" if geographic else "globe")
                assert counts or (elsewhere and told(made, title)), (list(frame.columns), made.remarks())
            assert all(told(made, title) for title in plain), (list(frame.columns), made.remarks())
        if number % 10 == 0 and not any(isinstance(v, list | datetime.datetime) for v in frame.to_numpy().ravel()):
            path = tmp_path / "frame.csv"
            frame.to_csv(path, index=False)
            read, also = outcome(lambda path=path: wb.read(path, vehicles=2, speed=50.0, time_unit="min"))  # type: ignore[return-value]
            tally["the same from a file"] += 1
            assert (read is None) == (made is None), (why, also)
            assert read is None or all(told(read, title) for title in plain)
        if made is not None and others + plain and number % 100 == 1:
            solution = wb.solve(made, "highs", bound_time=0)
            assert all(title in str(solution) for title in plain if title.isascii())
            tally["solved"] += 1


@pytest.mark.filterwarnings("ignore:latitude and longitude may be swapped")
def test_what_is_granted_is_told(share: Callable[[int, int], int], tally: Any) -> None:
    rng = np.random.default_rng(SEED + 1)
    for frame, others, plain in frames(rng, share(100, 2_000)):
        if any(title.casefold() in OWN for title in others):
            continue
        made = wb.RoutingProblem.from_frame(frame, vehicles=2, extra=others, speed=50.0, time_unit="min")
        assert all(told(made, title) for title in (*others, *plain)), (list(frame.columns), made.remarks())
        tally["frames with columns that are granted"] += 1


def test_no_column_of_a_fleet_or_list_is_dropped(share: Callable[[int, int], int], tally: Any) -> None:
    rng = np.random.default_rng(SEED + 2)
    sites = pd.DataFrame({"id": ["d", "a", "b"], "x": [0, 3, 5], "y": [0, 4, -1]})
    lists = {
        "fleet": {"count": [1, 1], "capacity": [5, 6]}, "windows": {"site": ["a", "b"], "ready": [0, 1], "due": [9, 9]},
        "shipments": {"pickup": ["a"], "delivery": ["b"]}, "groups": {"group": ["g", "g"], "site": ["a", "b"]},
    }  # fmt: skip
    for _ in range(share(200, 4_000)):
        table = list(lists)[int(rng.integers(len(lists)))]
        name = FOREIGN[table][int(rng.integers(len(FOREIGN[table])))]
        title = spelt(rng, name)
        if title in lists[table]:
            continue
        rows = pd.DataFrame(lists[table])
        rows[title] = pd.Series(values(rng, len(rows)))
        made, why = outcome(lambda table=table, rows=rows: wb.RoutingProblem.from_frame(sites, **{table: rows}))
        assert made is None and title in why, (table, title, made, why)
        own = next((own for own, names in OURS[table].items() if name in names.split()), None)
        assert own is None or f"'{own}" in why, (title, why)
        tally["fleets and lists with columns of other names"] += 1
