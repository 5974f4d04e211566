from typing import Any

import numpy as np
import pandas as pd
import pytest
from coded import coded
from file_cases import check_refused, refused

from waybound.instances.errors import InputError
from waybound.instances.routing.frame_columns import columns_of, words_of

SITES = pd.DataFrame({"id": ["yard", "a", "b"], "x": [0, 3, 6], "y": [0, 4, 8], "demand": [np.nan, 2, 3]})


def test_other_columns_are_kept_as_plain_values() -> None:
    day = pd.Timestamp("2026-05-04")
    table = columns_of(SITES.assign(phone=["-", None, "12"], since=[day, pd.NaT, day], stars=np.array([1, 2, 3])), None, ())
    assert table.extra == ("phone", "since", "stars")
    assert table.attributes() == {
        "phone": ["-", None, "12"], "since": ["2026-05-04T00:00:00", None, "2026-05-04T00:00:00"], "stars": [1, 2, 3]
    }  # fmt: skip


@pytest.mark.parametrize("mapping", [{"demand": "crates"}, {"crates": "demand"}])
def test_a_mapping_may_be_given_either_way_round(mapping: dict[str, str]) -> None:
    table = columns_of(SITES.rename(columns={"demand": "crates"}), mapping, ())
    assert table.reals("demand").tolist() == [0, 2, 3] and not table.extra


@pytest.mark.parametrize(
    ("frame", "ids"),
    [
        (SITES, ("yard", "a", "b")),
        (SITES.drop(columns="id").assign(name=list("pqr")), ("p", "q", "r")),
        (SITES.drop(columns="id").assign(name=list("ppr")), ("0", "1", "2")),
        (SITES.set_index("id"), ("yard", "a", "b")),
        (SITES.assign(id=[1.0, 2.0, 7.0]), ("1", "2", "7")),
    ],
)
def test_ids_are_the_column_the_index_or_the_names(frame: pd.DataFrame, ids: tuple[str, ...]) -> None:
    assert columns_of(frame, None, True).ids == ids


@pytest.mark.parametrize(
    ("title", "meant"),
    [
        ("dmand", "demand"), ("Demands", "demand"), ("demand_kg", "demand"), ("ready time", "ready"), ("due_date", "due"),
        ("tw_end", "due"),
        ("service_time", "service"), ("Latitud", "lat"),
    ],
)  # fmt: skip
def test_a_title_that_looks_misspelt_is_refused_with_both_cures(title: str, meant: str) -> None:
    frame = SITES.drop(columns="demand").assign(**{title: 1.0})
    with pytest.raises(InputError) as error:
        columns_of(frame, None, ())
    assert f"did you mean {meant!r}?" in str(error.value) and f"columns={{{meant!r}: {title!r}}}" in str(error.value)
    assert columns_of(frame, {meant: title}, ()).titles[meant] == title
    assert columns_of(frame, None, [title]).extra == (title,)
    assert columns_of(frame, None, True).extra == (title,)


def test_a_title_beside_the_one_that_it_looks_like_is_kept() -> None:
    assert columns_of(SITES.assign(demand_note="fragile"), None, ()).extra == ("demand_note",)
    assert columns_of(SITES.assign(note="fragile", idea=1), None, ()).extra == ("note", "idea")  # no misspelt node, no id


@pytest.mark.parametrize(
    ("frame", "mapping", "extra", "message"),
    [
        (SITES, {"demand": "crats"}, (), "columns maps 'demand' to the column 'crats', which is not there"),
        (SITES.assign(crates=1), {"demand": "crats"}, (), "did you mean 'crates'?"),
        (SITES, {"wheels": "tyres"}, (), "names no title of waybound"),
        (SITES.assign(latitude=1.0, lat=1.0), None, (), "both tell lat"),
        (SITES, None, ["fone"], "extra names the column 'fone', which is not there"),
        (SITES.assign(id=["a", None, "b"]), None, (), "row 2 has no id"),
        (pd.concat([SITES, SITES["x"]], axis=1), None, (), "column 'x' stands twice"),
        ([1, 2], None, (), "sites must be a pandas frame"),
    ],
)
def test_what_cannot_be_meant_is_refused(frame: Any, mapping: Any, extra: Any, message: str) -> None:
    assert message in refused(columns_of, frame, mapping, extra)


def test_missing_values_are_nothing_at_a_depot_and_a_fault_elsewhere() -> None:
    table = columns_of(SITES.assign(demand=[np.nan, 2, np.nan], required=[None, True, None]), None, ())
    assert np.isnan(table.reals("demand")[2]) and table.reals("demand")[0] == 0
    assert table.flags("required").tolist() == [True, True, True]


def test_words_have_commas_between() -> None:
    assert (
        words_of("cold, tall", "skills") == ["cold", "tall"] and words_of(["cold"], "skills") == ["cold"] and words_of(None, "skills") == []
    )
    with pytest.raises(InputError, check=coded("malformed")):
        words_of(3, "skills")


@pytest.mark.parametrize("other", ["demands", "Demand", "DEMANDS"])
def test_two_columns_that_mean_the_same_are_refused_unless_one_is_granted(other: str) -> None:
    frame = SITES.assign(**{other: 1})
    with pytest.raises(InputError, match=f"columns 'demand' and '{other}' both tell demand; expected one of them, or extra=") as caught:
        columns_of(frame, None, ())
    assert caught.value.code == "ambiguous"
    assert columns_of(frame, None, [other]).extra == (other,)
    assert columns_of(frame, {"demand": other}, ()).titles["demand"] == other


def test_another_load_beside_the_demand_is_refused_with_the_next_title() -> None:
    frame = SITES.assign(weight_kg=[0, 5, 6])
    for mapping in (None, {"demand": "demand"}):
        check_refused(InputError, r"column 'weight_kg' is unknown; did you mean 'demand2'\?", columns_of, frame, mapping, ())
    assert columns_of(frame, {"demand2": "weight_kg"}, ()).loads("demand").tolist()[1] == [2, 5]
    assert columns_of(frame.drop(columns="demand"), {"demand": "weight_kg"}, ()).reals("demand").tolist() == [0, 5, 6]


def test_titles_count_in_any_case_and_what_is_granted_beside_them_does_not() -> None:
    frame = SITES.rename(columns={"demand": "Demand", "x": "X", "y": "Y"})
    assert columns_of(frame, None, ()).titles == {"id": "id", "x": "X", "y": "Y", "demand": "Demand"}
    assert columns_of(frame, None, ["Demand"]).extra == ("Demand",) and "demand" not in columns_of(frame, None, ["Demand"])
    assert "demand" in columns_of(SITES, None, list(SITES.columns)) and "demand" in columns_of(frame, None, True)


def test_a_location_is_an_address_or_a_place_that_counts() -> None:
    assert columns_of(SITES.assign(location="Main Street 5"), None, ()).extra == ("location",)
    with pytest.raises(InputError, match="column 'location' is unknown; coordinates are the columns x and y, or lat and lon"):
        columns_of(SITES.assign(location=[1, 2, 3]), None, ())


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (SITES.set_index(["id", "x"]), "the index is called 'x', and columns alone tell x; expected frame.reset_index()"),
        (SITES.set_index("demand"), "the index is called 'demand', and columns alone tell demand"),
        (SITES.rename(columns={"demand": "qty"}).set_index("qty"), "the index is called 'qty', and columns alone tell demand"),
        (SITES.drop(columns="id").set_index([["p", "q", "r"], [1, 2, 3]]), "the index has several levels"),
        (pd.concat({"p": SITES}, axis=1), "titles of columns have several levels"),
    ],
)
def test_an_index_holds_ids_and_nothing_else(frame: Any, message: str) -> None:
    assert message in refused(columns_of, frame, None, ())
    assert columns_of(SITES.set_index("id"), None, ()).ids == tuple(map(str, SITES["id"]))


def test_titles_are_mapped_by_a_text_as_by_a_mapping() -> None:
    frame = SITES.rename(columns={"demand": "crates", "id": "shop"})
    for given in ("demand=crates, id=shop", "crates=demand,shop=id"):
        assert columns_of(frame, given, ()).titles == columns_of(frame, {"demand": "crates", "id": "shop"}, ()).titles
    for given in ("demand", "", "demand=crates=id"):
        check_refused(InputError, "columns must pair titles; expected demand=crates, id=shop", columns_of, frame, given, ())
