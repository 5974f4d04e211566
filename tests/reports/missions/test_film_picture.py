import numpy as np
import pytest

from waybound import run
from waybound.reports.missions.animation import Film
from waybound.reports.missions.film_picture import TRAIL, Picture
from waybound.reports.missions.mission import MISSIONS
from waybound.reports.missions.sata.tracking import Tracking

SMALL = {"robots": 3, "targets": 6, "width": 60.0, "height": 60.0}


@pytest.fixture(scope="module")
def film() -> Film:
    made = Film(Tracking())
    run(made.mission, steps=TRAIL + 3, seed=2, heuristic="greedy", watch=made, **SMALL)
    return made


def test_trails_go_back_so_many_steps_and_end_where_things_are(film: Film) -> None:
    picture = Picture({"": film})
    (stage,) = picture.stages
    for step, length in ((0, 0), (3, 4), (TRAIL + 2, TRAIL + 1)):
        picture.show(step)
        ways = stage.wakes.get_segments()
        assert all(len(way) == length for way in ways)
        if length:
            now = film.shots[step][0].points
            assert all(np.abs(now - way[-1]).sum(axis=1).min() < 1e-9 for way in ways) and ways


def test_headings_point_where_robots_face(film: Film) -> None:
    picture = Picture({"": film})
    picture.show(5)
    stage, scene = picture.stages[0], film.shots[5][0]
    drawn = np.arctan2(stage.headings.V, stage.headings.U)
    np.testing.assert_allclose(np.cos(drawn), np.cos(scene.headings), atol=1e-9)
    np.testing.assert_allclose(np.sin(drawn), np.sin(scene.headings), atol=1e-9)


def test_assignments_are_lines_from_robots_to_targets(film: Film) -> None:
    picture = Picture({"": film})
    picture.show(4)
    scene = film.shots[4][0]
    drawn = picture.stages[0].links.get_segments()
    assert len(drawn) == len(scene.links) > 0
    targets = [point for _, point in scene.links]
    assert len(targets) == len(set(targets))  # winner takes all: each target is credited once
    for line, (robot, target) in zip(drawn, scene.links, strict=True):
        np.testing.assert_allclose(line, [scene.agents[robot], scene.points[target]])


def test_a_policy_assigns_nothing() -> None:
    made = Film(Tracking())
    run(made.mission, steps=2, seed=2, policy="stay", watch=made, **SMALL)
    assert all(not scene.links for scene, _ in made.shots)
    assert "assigned" not in [text.get_text() for text in Picture({"": made}).figure.legends[0].get_texts()]


def test_several_films_have_a_map_and_a_curve_each(film: Film) -> None:
    picture = Picture({"one": film, "two": film})
    picture.show(2)
    assert [stage.film for stage in picture.stages] == [film, film]
    assert [curve.get_xdata()[-1] for curve in picture.past] == [2, 2]
    assert [ax.get_title() for ax in picture.figure.axes] == ["one", "two", ""]


def test_what_each_agent_added_is_a_band_of_its_colour_below_what_could_be_at_most() -> None:
    made = Film(MISSIONS["information-gathering"]())
    run(made.mission, steps=70, seed=1, policy="auction", watch=made, robots=3, rows=10, columns=10, sensors=6)
    picture = Picture({"": made})
    picture.show(70)
    scene, gain = made.shots[70]
    heights = [area.get_xy()[:71, 1] - area.get_xy()[:70:-1, 1] for area in picture.areas]
    np.testing.assert_allclose([height[-1] for height in heights], scene.shares)
    assert picture.most[0].get_ydata()[-1] == scene.limit > gain > 0
    assert picture.title.get_text().endswith(f"gain {gain:.5g} of at most {scene.limit:.5g}")
    assert [text.get_text() for text in picture.stages[0].notes] == list(scene.notes)
    assert len({tuple(colour) for colour in picture.stages[0].agents.get_facecolors().tolist()}) == 3
    both = Picture({"one": made, "two": made})
    assert not both.areas and len(both.most) == 2


def test_only_a_headline_that_counts_points_is_told_of_how_many(film: Film) -> None:
    counted = Picture({"": film})
    assert counted.counts and counted.title.get_text().endswith(" of 6")
    way = Film(MISSIONS["uncertain-graph"]())
    run(way.mission, steps=TRAIL, seed=1, policy="greedy", watch=way, vertices=12)
    picture = Picture({"": way})
    picture.show(TRAIL)
    assert not picture.counts and " of " not in picture.title.get_text()
    assert "all" not in [text.get_text() for axes in picture.figure.axes for text in axes.texts]
    (trail,) = picture.stages[0].trails.get_segments()
    assert len({tuple(at) for at in trail.tolist()}) == len({tuple(scene.agents[0]) for scene, _ in way.shots}) > 2
