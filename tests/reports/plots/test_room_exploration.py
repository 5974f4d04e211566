"""Pictures of explorations of rooms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from waybound.formulations.auctions.room_exploration import RoomExploration
from waybound.instances.generating import generate
from waybound.reports.plots.room_exploration import APART, places, plot_room_exploration


def corridor() -> RoomExploration:
    given = generate("exploration-map", 3)
    return RoomExploration(given)


def test_each_robot_has_a_line_through_the_rooms_of_its_steps() -> None:
    problem = corridor()
    answer = problem.answer_at_hand()
    ax = plot_room_exploration(problem, answer)
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
