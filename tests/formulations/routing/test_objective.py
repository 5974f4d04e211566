import math

import pytest
from coded import check_coded, coded
from draws import draws
from file_cases import check_refused
from hypothesis import given, settings, strategies as st

import waybound as wb
from waybound import Makespan
from waybound.formulations.routing.objective import TERMS, Composable, Objective, Reward, TotalCost, Vehicles, Weighted, objective_from
from waybound.instances.errors import Code, UsageError


def test_the_sense_of_a_level_is_that_of_its_first_term():
    assert Objective.of(TotalCost()).senses == ("min",)
    assert Reward().then(Makespan()).senses == ("max", "min")
    assert Objective.of(Reward() - 0.5 * TotalCost()).senses == ("max",)
    assert Objective.of(-1.0 * Reward() + TotalCost()).senses == ("min",)


def test_weights_spread_over_sums_and_differences():
    assert (2 * (TotalCost() + 3 * Vehicles())).terms == ((2.0, TotalCost()), (6.0, Vehicles()))
    assert (TotalCost() - (Vehicles() + 2 * Makespan())).terms == ((1.0, TotalCost()), (-1.0, Vehicles()), (-2.0, Makespan()))


def test_then_appends_levels_in_order():
    objective = Vehicles().then(TotalCost()).then(Makespan())
    assert [str(level) for level in objective.levels()] == ["vehicles", "total-cost", "makespan"]
    assert objective.is_only(Vehicles, TotalCost, Makespan)
    assert not objective.is_only(Vehicles)
    assert not Objective.of(2.0 * TotalCost()).is_only(TotalCost)


def test_names_make_an_objective():
    assert Objective.named(("vehicles", "total-cost")) == Vehicles().then(TotalCost())
    check_refused(UsageError, "unknown objective term 'profit'", Objective.named, ("profit",))
    check_coded(UsageError, "missing", Objective.named, ())


def test_text_tells_weights_apart_that_differ_in_their_last_digits():
    near = 0.1 + 1e-12
    assert str(Objective.of(0.1 * TotalCost())) == "0.1*total-cost"
    assert str(Objective.of(near * TotalCost())) != str(Objective.of(0.1 * TotalCost()))
    assert str(Objective.of(TotalCost() - 2 * Vehicles())) == "total-cost - 2*vehicles"


@pytest.mark.parametrize("weight", [0.0, math.nan, math.inf])
def test_a_weight_must_be_finite_and_not_zero(weight):
    with pytest.raises(UsageError, match="weight of total-cost"):
        weight * TotalCost()


def test_levels_are_not_lost_in_a_sum():
    with pytest.raises(UsageError, check=coded("contradiction")):
        TotalCost() + Vehicles().then(TotalCost())  # type: ignore[operator]
    with pytest.raises(UsageError):
        Weighted(())


def test_a_composable_says_its_levels():
    with pytest.raises(TypeError):
        Composable()  # type: ignore[abstract]


@pytest.mark.parametrize(
    "aim", [TotalCost() + Vehicles() * 3, Reward() - 0.25 * Makespan(), (-2 * Makespan()).then(TotalCost() - Reward())]
)
def test_what_is_printed_reads_back_the_same(aim):
    objective = Objective.of(aim)
    assert Objective.named(tuple(str(level) for level in objective.levels())) == objective


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("reward - profit", "unknown objective term 'profit'"),
        ("x*reward", "weight of reward must be a number, not 'x'"),
        ("0*reward", "not zero"),
    ],
)
def test_a_sum_that_cannot_be_read_is_refused(text, message):
    with pytest.raises(UsageError, match=message):
        Objective.named((text,))


@pytest.mark.parametrize(
    ("text", "expected", "senses"),
    [
        ("total-cost", wb.TotalCost(), ("min",)),
        ("vehicles then total-cost", wb.Vehicles().then(wb.TotalCost()), ("min", "min")),
        ("Vehicles, THEN total_cost", wb.Vehicles().then(wb.TotalCost()), ("min", "min")),
        ("total-cost - 2*reward", wb.TotalCost() - 2 * wb.Reward(), ("min",)),
        ("reward - .5 makespan", wb.Reward() - 0.5 * wb.Makespan(), ("max",)),
        ("-1 * reward + 1e2*vehicles", -1 * wb.Reward() + 100 * wb.Vehicles(), ("min",)),
    ],
)
def test_terms_weights_and_priorities(text: str, expected: object, senses: tuple[str, ...]) -> None:
    made = objective_from(text)
    assert made == Objective.of(expected)  # type: ignore[arg-type]
    assert made.senses == senses


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("total-costs", "did you mean 'total-cost'?"), ("TotalCost", "did you mean 'total-cost'?"), ("vehicle", "did you mean 'vehicles'?"),
        ("distance", "choose from total-cost"), ("reward-total-duration", "write blanks around - and +: reward - total-duration"),
        ("2*", "ends without a term"), ("vehicles +", "ends without a term"), ("vehicles vehicles", "not expected there"),
        ("--vehicles", "not expected there"), ("vehicles * 2", "not expected there"), ("2 3*vehicles", "not expected there"),
        ("vehicles; total-cost", "not expected there"), ("vehicles\x1b[31m", "not expected there"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_on_one_line(text: str, told: str) -> None:
    with pytest.raises(wb.UsageError) as refused:
        objective_from(text)
    assert told in str(refused.value)
    assert str(refused.value).isprintable()


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "missing"), ("vehicles then", "missing"), ("vehicles then then total-cost", "missing"), ("vehicles + vehicles", "duplicate"),
        ("0*vehicles", "out-of-range"), ("1e400*vehicles", "out-of-range"),
    ],
)  # fmt: skip
def test_what_is_missing_twice_or_out_of_range_has_a_code(text: str, code: Code) -> None:
    with pytest.raises(wb.UsageError, check=coded(code)) as refused:
        objective_from(text)
    assert str(refused.value).isprintable()


WEIGHTS = st.floats(-1e6, 1e6, allow_nan=False).filter(lambda w: w != 0)
LEVELS = st.lists(st.tuples(WEIGHTS, st.sampled_from(sorted(TERMS))), min_size=1, max_size=4, unique_by=lambda pair: pair[1])


@settings(max_examples=draws(100), deadline=None)
@given(st.lists(LEVELS, min_size=1, max_size=3))
def test_what_an_objective_prints_reads_back(levels: list[list[tuple[float, str]]]) -> None:
    made = Objective(tuple(Weighted(tuple((w, TERMS[name]()) for w, name in level)) for level in levels))
    assert objective_from(str(made)) == made


@settings(max_examples=draws(100), deadline=None)
@given(st.text(alphabet="-+*.e01 ,thenvhiclsoa", max_size=30))
def test_any_text_is_an_objective_or_one_clear_error(text: str) -> None:
    try:
        made = objective_from(text)
    except wb.UsageError as error:
        assert "\n" not in str(error)
    else:
        assert objective_from(str(made)) == made


def test_files_constructors_and_frames_take_text() -> None:
    problem = wb.read("demo-tiny", objective="vehicles then total-cost")
    assert problem.senses == ("min", "min")
    same = wb.RoutingProblem(problem.sites, problem.travel, problem.fleet, objective="vehicles then total-cost")
    assert same.objective == problem.objective


def test_a_term_that_would_count_nothing_is_refused() -> None:
    with pytest.raises(wb.UsageError, match="no site of demo-tiny has any reward"):
        wb.read("demo-tiny", objective="total-cost - reward")


def test_other_families_have_no_such_setting() -> None:
    with pytest.raises(wb.UsageError, match="objective"):
        wb.read("sata-s3", objective="vehicles")
