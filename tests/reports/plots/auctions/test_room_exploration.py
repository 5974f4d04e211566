from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.offsetbox import AnnotationBbox
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from waybound.formulations.auctions.room_exploration import RoomExploration
from waybound.instances.generating import generate
from waybound.reports.plots.auctions.room_exploration import APART, places, plot_room_exploration


def corridor() -> RoomExploration:
    given = generate("exploration-map", 3)
    return RoomExploration(given)


def test_each_robot_has_a_line_through_the_rooms_of_its_steps() -> None:
    problem = corridor()
    ax = plot_room_exploration(problem, problem.answer_at_hand())
    lines = ax.get_lines()
    assert len(lines) == problem.instance.num_robots and all(len(line.get_xdata()) == problem.instance.steps + 1 for line in lines)
    at = places(problem)
    length = np.hypot(*(at[problem.instance.doors[:, 0]] - at[problem.instance.doors[:, 1]]).T).mean()
    for line, start in zip(lines, problem.instance.starts, strict=True):
        assert np.hypot(*(line.get_xydata()[0] - at[start])) <= 1.01 * APART * length


def test_observers_are_marked_and_the_caption_counts_rooms() -> None:
    problem = corridor()
    answer = tuple(((int(start), 1), *deeds[1:]) for start, deeds in zip(problem.instance.starts, problem.answer_at_hand(), strict=True))
    plain, marked = (plot_room_exploration(problem, given) for given in (problem.answer_at_hand(), answer))
    drawn = [
        sum(len(c.get_offsets()) for c in ax.collections if hasattr(c, "get_paths") and len(c.get_offsets()) < 20) for ax in (plain, marked)
    ]
    assert drawn[1] == drawn[0] + problem.instance.num_robots
    entered = len(set(problem.instance.starts.tolist()))
    assert any(f"{entered} of {problem.instance.num_rooms} rooms entered" in text.get_text() for text in marked.texts)


def test_without_positions_rooms_lie_as_far_apart_as_steps() -> None:
    given = replace(generate("exploration-map", 3), positions=None)
    problem = RoomExploration(given)
    at = places(problem)
    assert at.shape == (given.num_rooms, 2) and np.isfinite(at).all()
    plot_room_exploration(problem, problem.answer_at_hand())


def labels_of(ax: Any) -> list[tuple[list[str], Any]]:
    """Texts and box in pixels of each label of a room."""
    ax.figure.canvas.draw()
    return [
        ([text.get_text() for text in box.findobj(Text) if text.get_text()], box.get_window_extent(ax.figure.canvas.get_renderer()))
        for box in ax.findobj(AnnotationBbox)
    ]


@pytest.mark.parametrize(("seed", "robots"), [(1, 1), (3, 2), (4, 3), (7, 3)])
def test_labels_lie_beside_all_lines_and_within_the_picture(seed: int, robots: int) -> None:
    problem = RoomExploration(generate("exploration-map", seed, robots=robots))
    rng, given = np.random.default_rng(seed), problem.instance
    answer = []
    for start in given.starts.tolist():
        rooms = [start]
        for _ in range(given.steps):
            rooms.append(int(rng.choice(np.nonzero(given.adjacent[rooms[-1]])[0])))
        answer.append(tuple((room, 0) for room in rooms[1:]))
    ax = plot_room_exploration(problem, tuple(answer))
    labels = labels_of(ax)
    assert len(labels) == given.num_rooms
    inside = ax.get_window_extent()
    for texts, box in labels:
        assert inside.x0 <= box.x0 and box.x1 <= inside.x1 and inside.y0 <= box.y0 and box.y1 <= inside.y1
        for line in ax.get_lines():
            way = Path(ax.transData.transform(line.get_xydata()))
            assert not way.intersects_bbox(Bbox.from_extents(*box.extents), filled=False), texts


def test_steps_of_a_robot_that_goes_there_and_back_are_numbered_in_their_order() -> None:
    given = replace(
        generate("exploration-map", 1, robots=1), doors=[[0, 1], [1, 2]], heard=[[0, 1], [1, 2]], exploring=np.ones((3, 1)),
        mapping=np.zeros((3, 0)), searching=np.zeros((3, 1)), starts=[1], base=0, steps=6, room_names=None, positions=None,
    )  # fmt: skip
    ways = (((0, 0), (1, 0), (2, 0), (1, 0), (1, 2), (0, 0)),)
    told = {texts[0]: texts[1:] for texts, _ in labels_of(plot_room_exploration(RoomExploration(given), ways))}
    assert told == {"1": ["1, 6"], "2": ["0, 2, 4-5"], "3": ["3"]}
