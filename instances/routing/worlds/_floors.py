"""Floors that robots explore: rooms, mazes, blocks, and maps from files."""

import numpy as np

from ...errors import InputError
from ...generators import Draw, Flags
from ...text import read_text


def rooms(rng: np.random.Generator, height: int, width: int, doors: float, pitch: int) -> Flags:
    """Rooms of ``pitch`` cells, a wall included, all joined by doors of two cells; further walls have one with probability ``doors``."""
    draw, door = Draw(rng), min(2, pitch - 1)
    free = np.ones((height, width), dtype=bool)
    free[pitch - 1 : height - 1 : pitch], free[:, pitch - 1 : width - 1 : pitch] = False, False
    down, across = len(range(pitch - 1, height - 1, pitch)) + 1, len(range(pitch - 1, width - 1, pitch)) + 1
    walls = [
        ((r, c), (r + v, c + 1 - v)) for r in range(down) for c in range(across) for v in (0, 1) if r + v < down and c + 1 - v < across
    ]
    joined = {(r, c): (r, c) for r in range(down) for c in range(across)}
    chances = draw.uniform(0.0, 1.0, len(walls))
    for k in draw.permutation(len(walls)).tolist():
        (r, c), other = walls[k]
        a, b, along = joined[r, c], joined[other], width - c * pitch if other[0] > r else height - r * pitch
        place = draw.integer(0, max(min(pitch - 1, along) - door, 0))
        if a != b or chances[k] < doors:
            joined = {room: a if part == b else part for room, part in joined.items()}
            if other[0] > r:
                free[(r + 1) * pitch - 1, c * pitch + place : c * pitch + place + door] = True
            else:
                free[r * pitch + place : r * pitch + place + door, (c + 1) * pitch - 1] = True
    return free


def blocks(rng: np.random.Generator, height: int, width: int) -> Flags:
    """An open floor with a block of 2 to 6 cells a side for each 100 cells."""
    free = np.ones((height, width), dtype=bool)
    for row, column, h, w in Draw(rng).integers(0, 2**31 - 1, (height * width // 100, 4)).tolist():
        free[row % height :, column % width :][: 2 + h % 5, : 2 + w % 5] = False
    return free


def read_floor(path: str) -> tuple[Flags, tuple[int, int]]:
    """Free cells and base of a map: lines of ``#`` (wall), ``.`` (free) and one ``B`` (the base). Raises InputError."""
    lines = [line.rstrip() for line in read_text(path).split("\n")]
    bad = [(k + 1, sign) for k, line in enumerate(lines) for sign in line if sign not in "#.B"]
    if bad:
        raise InputError("an unknown sign of a map", "malformed", file=path, line=bad[0][0], expected="#, . or B", found=repr(bad[0][1]))
    bases = [(k, column) for k, line in enumerate(lines) for column, sign in enumerate(line) if sign == "B"]
    if len(bases) != 1:
        raise InputError("the map has no single base", "missing", file=path, expected="one B", found=str(len(bases)))
    longest = max(map(len, lines))
    return np.array([[sign in ".B" for sign in line.ljust(longest, "#")] for line in lines]), bases[0]
