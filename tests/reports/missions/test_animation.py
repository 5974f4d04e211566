import io

import numpy as np
import pytest
from coded import check_coded, coded
from file_cases import check_refused

from waybound import InputError, UsageError, run
from waybound.instances.worlds import World
from waybound.reports.missions.animation import MOST_FRAMES, Film, save_side_by_side
from waybound.reports.missions.mission import Mission
from waybound.reports.missions.sata.tracking import Tracking

SMALL = {"robots": 3, "targets": 4, "width": 60.0, "height": 60.0}


@pytest.fixture(scope="module")
def film():
    mission = Tracking()
    made = Film(mission)
    return made, run(mission, steps=4, seed=2, policy="force-vector", watch=made, **SMALL)


def test_a_film_holds_the_start_and_every_step(film):
    made, log = film
    assert len(made.shots) == 5
    assert made.values[1:] == log["observed"].tolist()
    assert [int(scene.marked.sum()) for scene, _ in made.shots] == made.values
    assert made.frames() == [0, 1, 2, 3, 4]


def test_a_gif_has_one_frame_a_step(film, tmp_path):
    from PIL import Image

    film[0].save(tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as image:
        assert image.n_frames == 5
        first = np.asarray(image.convert("RGB")).astype(int)
        image.seek(4)
        last = np.asarray(image.convert("RGB")).astype(int)
    assert np.abs(first - last).sum() > 0
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]


def test_a_page_holds_all_frames_and_needs_no_other_file(film, tmp_path):
    film[0].save(tmp_path / "film.html")
    assert (tmp_path / "film.html").read_text().count("data:image/png;base64") == 5
    assert [path.name for path in tmp_path.iterdir()] == ["film.html"]


def test_a_frame_is_drawn_where_things_are(film, tmp_path):
    film[0].save_frame(4, tmp_path / "frame.png")
    from PIL import Image

    pixels = np.asarray(Image.open(io.BytesIO((tmp_path / "frame.png").read_bytes())).convert("RGB")).astype(int)
    indigo = (np.abs(pixels - [0x33, 0x22, 0x88]).sum(axis=2) < 10).sum()
    assert indigo > 3 * 20  # three robots, filled squares


def test_long_runs_show_every_so_many_steps_and_the_last(film):
    made = Film(Tracking())
    made.shots = [film[0].shots[0]] * (3 * MOST_FRAMES + 2)
    frames = made.frames()
    assert len(frames) <= MOST_FRAMES + 1
    assert frames[0] == 0
    assert frames[-1] == 3 * MOST_FRAMES + 1


def test_what_cannot_be_shown_or_written_is_refused(film, tmp_path):
    check_refused(UsageError, r"\.gif or \.html", film[0].save, tmp_path / "film.mp4")
    check_coded(UsageError, "missing", Film(Tracking()).save, tmp_path / "film.gif")
    check_refused(InputError, "no folder", film[0].save, tmp_path / "missing" / "film.gif")
    assert list(tmp_path.iterdir()) == []


def test_a_mission_without_pictures_is_refused():
    class Dark(Mission):
        name, summary, headline = "dark", "no pictures", "x"

        def world(self, seed, **settings):
            return World()

        def problem(self, observation):
            return None

        def actions(self, observation, problem, answer):
            return {}

    with pytest.raises(UsageError, match="dark", check=coded("unsupported")):
        Film(Dark())


@pytest.mark.slow
def test_two_methods_are_shown_beside_each_other(film, tmp_path):
    other = Film(Tracking())
    run(other.mission, steps=4, seed=2, policy="stay", watch=other, **SMALL)
    save_side_by_side({"force vectors": film[0], "stay": other}, tmp_path / "both.gif")
    from PIL import Image

    with Image.open(tmp_path / "both.gif") as both:
        assert both.n_frames == 5
    other.shots.pop()
    with pytest.raises(UsageError, check=coded("wrong-shape")):
        save_side_by_side({"a": film[0], "b": other}, tmp_path / "c.gif")
    other.over = True  # its last picture stays
    save_side_by_side({"a": film[0], "b": other}, tmp_path / "c.gif")
    with Image.open(tmp_path / "c.gif") as both:
        assert both.n_frames == 5
    assert len(other.shots) == 4
