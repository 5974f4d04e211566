import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.ndimage import label

from waybound.instances.errors import InputError
from waybound.instances.routing.worlds._floors import blocks, read_floor, rooms
from waybound.instances.worlds import make_world


@given(st.integers(0, 10**6), st.integers(2, 11), st.integers(1, 40), st.integers(1, 40), st.floats(0, 1))
def test_all_rooms_are_joined(seed, pitch, height, width, doors):
    floor = rooms(np.random.default_rng(seed), height, width, doors, pitch)
    assert floor.shape == (height, width) and label(floor)[1] == 1


def test_blocks_leave_most_of_the_floor():
    assert 0.6 < blocks(np.random.default_rng(1), 50, 50).mean() < 0.95


@pytest.mark.parametrize(
    ("text", "message"),
    [("...\n", "no single base; expected one B; found 0"), ("B.B", "found 2"), ("B.?", "line 1|1: an unknown sign")],
)
def test_maps_that_make_no_floor_are_refused(tmp_path, text, message):
    path = tmp_path / "floor.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        make_world("unreliable-communication", 1, file=str(path))


def test_a_map_is_read_and_what_cannot_be_reached_counts_as_wall(tmp_path):
    path = tmp_path / "floor.txt"
    path.write_text("#B.\n..\n\n  \n...\n".replace(" ", "#"))
    free, base = read_floor(str(path))
    assert base == (0, 1) and free.shape == (6, 3) and free.sum() == 7
    assert make_world("unreliable-communication", 1, file=str(path)).free.sum() == 4
    path.write_bytes(b"\xef\xbb\xbf#B.\r\n..")  # as editors of Windows write it
    assert read_floor(str(path))[0].tolist() == [[False, True, True], [True, True, False]]
    with pytest.raises(InputError, match="no such file"):
        read_floor(str(tmp_path / "none.txt"))
    with pytest.raises(InputError, match="is a device"):
        read_floor("/dev/zero")
