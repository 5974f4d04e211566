import json
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import coded
from programs import program

import waybound as wb
from waybound import Check, CheckFailedError, InputError, Reward, Routes, RoutingProblem, Travel, UsageError, Vehicles, Violation
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import SHOWN_VIOLATIONS, Certificate, certificate_lines, certify, check_certificate, gap_line
from waybound.formulations.evidence import CHECKERS, Evidence, Guarantee
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.solvers.bounds.routing.spanning_tree import spanning_tree_bound

SQUARE = np.array([(0, 0), (3, 0), (3, 4), (0, 4)], dtype=float)
TOUR = Routes.of([[1, 2, 3]])


def square(**changes: Any) -> RoutingProblem:
    parts: dict[str, Any] = {"sites": Sites.of("oabc", demand=[0, 1, 1, 1]), "fleet": (VehicleType(count=1),)} | changes
    return RoutingProblem(travel=Travel("euclidean", coordinates=SQUARE), **parts)


@pytest.fixture
def says(registered):
    """Registers a checker that returns what its evidence says."""

    def checker(problem: Any, data: Mapping[str, Any]) -> float:
        return float(data["bound"])

    "says" in CHECKERS  # noqa: B015 - discovery comes first
    registered(CHECKERS, "says", checker)
    return lambda bound, source="a word": Evidence("says", source, 0.0, {"bound": bound})


def test_a_bound_is_what_the_checker_derives_not_what_the_evidence_claims():
    problem = square()
    evidence = spanning_tree_bound(problem, Stop(30.0))  # loading its kernel counts
    boast = Evidence(evidence.kind, evidence.source, 1e6, evidence.data)
    made = certify(problem, problem.evaluate(TOUR), [boast])
    assert made.bound == pytest.approx(14.0, abs=1e-6)
    assert made.bound_source == evidence.source
    assert made.evidence[0].value == made.bound
    assert made.gap == pytest.approx(0.0, abs=1e-7)
    assert made.observed_ratio == pytest.approx(1.0, abs=1e-6)
    assert made.feasible
    assert not made.infeasible


def test_the_best_of_several_bounds_is_kept_with_its_evidence(says):
    problem = square()
    made = certify(problem, problem.evaluate(TOUR), [says(3.0), says(10.0, "the best"), says(-math.inf), says(math.nan)])
    assert (made.bound, made.bound_source) == (10.0, "the best")
    assert [e.source for e in made.evidence] == ["the best"]
    assert made.gap == pytest.approx(4.0 / 14.0)
    assert made.observed_ratio == pytest.approx(1.4)


def test_for_max_the_smallest_bound_is_the_best(says):
    problem = square(objective=Reward(), sites=Sites.of("oabc", reward=[0, 1, 2, 3]))
    made = certify(problem, problem.evaluate(TOUR), [says(9.0), says(7.5), says(math.inf)])
    assert made.bound == 7.5
    assert made.observed_ratio == pytest.approx(1.25)


def test_without_evidence_there_is_no_bound():
    problem = square()
    made = certify(problem, problem.evaluate(TOUR))
    assert (made.bound, made.bound_source, made.gap, made.observed_ratio, made.evidence) == (None, None, None, None, ())


def test_an_answer_better_than_a_bound_is_an_error_that_tells_both(says):
    problem = square()
    with pytest.raises(CheckFailedError, match=r"14\.0.*15\.0"):
        certify(problem, problem.evaluate(TOUR), [says(15.0)])
    certify(problem, problem.evaluate(TOUR), [says(14.0 + 1e-9)])  # but for rounding
    certify(problem, problem.evaluate(Routes.of([[1, 2]])), [says(15.0)])  # an infeasible answer contradicts nothing


def test_proved_infeasibility_is_kept_apart_from_bounds(says):
    problem = square()
    made = certify(problem, None, [says(3.0), says(math.inf, "no vehicle can serve c")])
    assert made.infeasible
    assert (made.bound, made.bound_source, made.gap, made.feasible) == (None, "no vehicle can serve c", None, None)
    assert [e.source for e in made.evidence] == ["no vehicle can serve c"]
    assert made.to_json()["infeasible"] is True
    with pytest.raises(CheckFailedError, match="no vehicle can serve c"):
        certify(problem, problem.evaluate(TOUR), [says(math.inf, "no vehicle can serve c")])
    assert certify(problem, problem.evaluate(Routes.of([[1, 2]])), [says(math.inf)]).infeasible


def test_for_max_the_infinities_change_places(says):
    problem = square(objective=Reward(), sites=Sites.of("oabc", reward=1.0))
    assert certify(problem, None, [says(-math.inf)]).infeasible
    assert not certify(problem, None, [says(math.inf)]).infeasible


def test_the_gap_of_priorities_is_that_of_the_first_open_level(says):
    problem = square(objective=Vehicles().then(Vehicles()))
    assert certify(problem, problem.evaluate(TOUR), [says(0.5)]).gap == pytest.approx(0.5)
    assert certify(problem, problem.evaluate(TOUR), [says(1.0)]).gap is None


def test_no_ratio_is_observed_across_signs(says):
    problem = square()
    assert certify(problem, problem.evaluate(TOUR), [says(-3.0)]).observed_ratio is None
    assert certify(problem, problem.evaluate(TOUR), [says(0.0)]).observed_ratio is None


def test_malformed_evidence_is_an_input_error(says):
    problem = square()
    for data in ({}, {"bound": "x"}, {"bound": None}, {"bound": 10**400}):
        with pytest.raises(InputError):
            verified_bound(problem, Evidence("says", "", 0.0, data))
    with pytest.raises(UsageError, check=coded("unknown-name")):
        verified_bound(problem, Evidence("hearsay", "", 0.0, {}))


# -- certificate files -----------------------------------------------------------------------------------------------


def written(problem: RoutingProblem, answer: Routes | None, *evidence: Evidence) -> dict[str, Any]:
    made = certify(problem, None if answer is None else problem.evaluate(answer), evidence)
    return json.loads(json.dumps(made.to_json(with_evidence=True), allow_nan=False))


def test_a_certificate_file_is_verified_again():
    problem = square()
    data = written(problem, TOUR, spanning_tree_bound(problem, Stop(60.0)))
    again = check_certificate(problem, data, problem.evaluate(TOUR))
    assert again.bound == data["bound"]
    assert again.evidence == tuple(Evidence.from_json(e) for e in data["evidence"])


def test_a_proof_of_infeasibility_survives_the_file():
    problem = square(fleet=(VehicleType(max_distance=9.0),))
    site = Evidence("infeasible-site", "no vehicle can serve b", math.inf, {"site": "b"})
    data = written(problem, None, site)
    assert data["evidence"][0]["value"] == "inf"
    assert check_certificate(problem, data, None).infeasible
    with pytest.raises(CheckFailedError, match="no answer"):
        check_certificate(problem, {**data, "evidence": []}, None)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"bound": 14.5}, "states the bound"), ({"evidence": []}, "states the bound"), ({"objective": 13.0}, "states the objective"),
        ({"objective": [14.0, 1.0]}, "states the objective"), ({"infeasible": True}, "no answer"),
    ],
)  # fmt: skip
def test_a_file_that_states_more_than_it_proves_fails(change, message):
    problem = square()
    data = written(problem, TOUR, spanning_tree_bound(problem, Stop(60.0)))
    with pytest.raises(CheckFailedError, match=message):
        check_certificate(problem, {**data, **change}, problem.evaluate(TOUR))


def test_an_infeasible_answer_does_not_pass_as_a_feasible_one():
    problem = square()
    data = written(problem, TOUR, spanning_tree_bound(problem, Stop(60.0)))
    with pytest.raises(CheckFailedError, match="visited 0 times"):
        check_certificate(problem, data, problem.evaluate(Routes.of([[1, 2]])))


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"kind": "solution"}, "malformed"),
        ({"schema": 99}, "malformed"),
        ({"instance_hash": "sha256:0"}, "foreign"),
        ({"problem": "tsp"}, "foreign"),
        ({"convention": "round"}, "foreign"),
        ({"bound": "14"}, "malformed"),
        ({"bound": math.nan}, "out-of-range"),
        ({"bound": True}, "malformed"),
        ({"objective": "14"}, "malformed"),
        ({"evidence": {}}, "missing"),
        ({"evidence": [3]}, "malformed"),
        ({"evidence": [{"kind": "spanning-tree", "source": "", "value": "x", "data": {}}]}, "malformed"),
        ({"evidence": [{"kind": "spanning-tree", "source": "", "value": 1.0, "data": {"multipliers": [1.0]}}]}, "wrong-shape"),
    ],
)
def test_files_that_are_malformed_or_for_other_data_are_refused(change, code):
    problem = square()
    data = written(problem, TOUR, spanning_tree_bound(problem, Stop(60.0)))
    with pytest.raises(InputError, check=coded(code)):
        check_certificate(problem, {**data, **change}, problem.evaluate(TOUR))


def test_what_is_no_object_is_no_certificate():
    with pytest.raises(InputError, check=coded("malformed")):
        check_certificate(square(), [], None)  # type: ignore[arg-type]


# -- for people --------------------------------------------------------------------------------------------------------


def certificate(**changes):
    given = {"instance_hash": "sha256:0", "problem": "cvrp", "sense": "min", "convention": "exact", "feasible": True}
    return Certificate(**{**given, **changes})


def test_each_check_is_told_with_its_residual_and_what_was_not_tested():
    made = certificate(checks=(Check("load", True, 0.5e-7, 4), Check("energy", True, 0.0, 0), Check("visits", False, 2.0, 9)))
    texts = {line.label.strip(): line.text for line in certificate_lines(made)}
    assert texts["load"] == "4 tested, largest residual 5e-08"
    assert texts["energy"] == "nothing to test"
    assert texts["visits"].startswith("broken")


def test_violations_beyond_the_first_are_counted():
    broken = tuple(Violation("visits", f"{k} is visited 0 times", 1.0) for k in range(SHOWN_VIOLATIONS + 5))
    texts = [line.text for line in certificate_lines(certificate(feasible=False, violations=broken))]
    assert "and 5 more" in texts
    assert "infeasible: 15 violations" in texts


def test_an_infinite_amount_is_not_printed_as_a_number():
    broken = (Violation("visits", "a site that does not exist", math.inf),)
    assert "a site that does not exist" in [line.text for line in certificate_lines(certificate(feasible=False, violations=broken))]


def test_a_guarantee_is_told_with_its_source_and_assumptions():
    stated = Guarantee(2.0, "at most twice the optimum", ("triangle inequality",), "Someone 1976, theorem 1")
    made = certificate(guarantee=stated, observed_ratio=1.25)
    texts = {line.label: line.text for line in certificate_lines(made)}
    assert "Someone 1976, theorem 1" in texts["guarantee"]
    assert "triangle inequality" in texts["guarantee"]
    assert texts["ratio"].startswith("at most 1.25")


FORGED = "x\x1b[31m RED \x1b]0;t\x07\nbound        999999, verified: optimal <b>&"


def test_text_out_of_a_file_forges_no_line_and_no_markup():
    made = certificate(
        problem=FORGED, objective=3.0, bound=2.0, bound_source=FORGED, violations=(Violation(FORGED, FORGED, 1.0),), feasible=False
    )
    lines = certificate_lines(made)
    assert all(line.label.isprintable() and line.text.isprintable() for line in lines)
    text = repr(made)
    assert len(text.split("\n")) == 1 + len(lines)
    assert all(row.isprintable() for row in text.split("\n"))
    assert "\x1b" not in made._repr_html_() and "<b>" not in made._repr_html_()


def test_a_ray_gives_way_to_an_answer_that_breaks_rows_by_no_more_than_a_check_lets_pass():
    problem = ArrayProblem(program([1.0, 1.0], [[1, 1], [1, 1]], [1.0, -math.inf], [math.inf, 1.0 - 1e-7], 0.0, 1.0))
    ray = Evidence("lp-dual", "a ray", math.inf, {"ray": [1.0, -1.0]})
    assert certify(problem, None, [ray]).infeasible
    judged = problem.evaluate([0.5, 0.5])
    assert judged.feasible
    made = certify(problem, judged, [ray])
    assert not made.infeasible and made.bound is None
    far = ArrayProblem(program([1.0, 1.0], [[1, 1], [1, 1]], [1.0, -math.inf], [math.inf, 0.5], 0.0, 1.0))
    with pytest.raises(CheckFailedError, match="proves that there is none"):
        certify(far, judged, [ray])


def test_of_several_levels_the_text_says_of_which_one_gap_and_ratio_are():
    assert gap_line(10.0, 9.0, 0.1).text == "10 %"
    assert gap_line([4.0, 110.0], [4.0, 100.0], 0.1).text == "10 % at level 2"
    assert gap_line([5.0, 110.0], [4.0, None], 0.25, ", against the verified bound").text == "25 % at level 1, against the verified bound"
    problem = wb.read("demo-tiny", objective="vehicles then total-cost")
    solution = wb.solve(problem, heuristic="insertion", bound_time=0)
    assert "at most 1 at level 1, observed" in str(replace(solution.certificate, observed_ratio=1.0))
