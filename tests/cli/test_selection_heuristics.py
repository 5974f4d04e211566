"""Heuristics for selections and assignments, called as on a command line."""

import pytest


@pytest.mark.parametrize(
    ("instance", "heuristic", "options", "least"),
    [
        ("cover-30", "greedy", ["eps=0.5"], 133), ("cover-30", "lazy-greedy", ["base=9,8"], 133),
        ("cover-30", "stochastic-greedy", ["eps=0.1"], 100), ("cover-30", "continuous-greedy", ["steps=20"], 90),
        ("cover-30", "lp-rounding", ["ties=first"], 0), ("cover-30", "brute-force", [], 142), ("cover-30", "random", [], 1),
    ],
)  # fmt: skip
def test_answers_come_with_their_evidence_as_json(json_of, instance, heuristic, options, least):  # type: ignore[no-untyped-def]
    given = [word for option in options for word in ("--option", option)]
    data = json_of("solve", instance, "--heuristic", heuristic, *given, "--bound-time", "60", "-q")
    assert data["objective"] >= least
    assert data["bound_kind"] == "verified" and data["bound"] >= 142 - 1e-6
    promised = heuristic in ("greedy", "stochastic-greedy", "continuous-greedy", "brute-force")
    assert (data["certificate"]["guarantee"] is not None) == promised


def test_an_order_of_robots_by_name(json_of):  # type: ignore[no-untyped-def]
    data = json_of("solve", "sata-s3", "--problem", "winner-takes-all", "--heuristic", "sequential-greedy", "--option", "order=3,2,1", "-q")
    assert data["certificate"]["guarantee"]["ratio"] == 2.0
    assert data["statistics"]["communication_rounds"] == 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("cover-30", "--heuristic", "greedy", "--option", "eps=-1"), "eps must be"),
        (("cover-30", "--heuristic", "sequential-greedy"), "constraint:cardinality; can take it: "),
        (("cover-30", "--heuristic", "knapsack-greedy"), "does not handle constraint:cardinality"),
        (
            ("sata-s3", "--problem", "winner-takes-all", "--heuristic", "sequential-greedy", "--option", "order=1,2"),
            "permutation of all 3 robots",
        ),
        (("sata-s3", "--problem", "bottleneck-lp", "--heuristic", "greedy"), "does not handle bottleneck-lp problems"),
    ],
)
def test_bad_requests_are_refused_in_one_line(refused, arguments, words):  # type: ignore[no-untyped-def]
    assert words in refused("solve", *arguments)
