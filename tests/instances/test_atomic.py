"""Files that are written whole or not at all."""

import os
from pathlib import Path

import pytest
from coded import coded

from waybound.instances.atomic import atomic_file, atomic_write, check_writable
from waybound.instances.errors import InputError


def test_text_and_bytes_are_written_as_they_are(tmp_path: Path) -> None:
    atomic_write(tmp_path / "a", "ü\n")
    atomic_write(tmp_path / "b", b"\r\n")
    assert (tmp_path / "a").read_bytes() == "ü\n".encode()
    assert (tmp_path / "b").read_bytes() == b"\r\n"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a", "b"]


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError, InputError])
def test_whatever_ends_the_writing_early_leaves_the_old_file_and_nothing_else(tmp_path: Path, error: type[BaseException]) -> None:
    path = tmp_path / "out.sol"
    path.write_text("old")
    with pytest.raises(error), atomic_file(path) as stream:
        stream.write(b"half of the new")
        raise error("stop")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["out.sol"]


def test_an_interrupt_leaves_no_file_where_there_was_none(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), atomic_file(tmp_path / "new") as stream:
        stream.write(b"x")
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


def test_text_that_cannot_be_encoded_leaves_nothing_behind(tmp_path: Path) -> None:
    with pytest.raises(UnicodeEncodeError):
        atomic_write(tmp_path / "a", "\ud800")
    assert list(tmp_path.iterdir()) == []


def test_a_directory_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, check=coded("file")):
        atomic_write(tmp_path, "x")


def test_a_missing_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, check=coded("file")):
        atomic_write(tmp_path / "none" / "a", "x")


def test_a_full_disk_is_one_line_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match="cannot be written: No space left on device"):
        atomic_write(tmp_path / "a", "x")
    assert list(tmp_path.iterdir()) == []


def test_permissions_are_those_of_the_replaced_file_or_of_a_new_one(tmp_path: Path) -> None:
    path, plain = tmp_path / "a", tmp_path / "plain"
    atomic_write(path, "x")
    plain.write_text("x")
    assert path.stat().st_mode == plain.stat().st_mode
    path.chmod(0o600)
    atomic_write(path, "y")
    assert path.stat().st_mode & 0o777 == 0o600


def test_a_symbolic_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    atomic_write(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_a_device_is_written_to_and_stays_one(tmp_path: Path) -> None:
    (tmp_path / "none").symlink_to("/dev/null")
    (tmp_path / "full").symlink_to("/dev/full")
    atomic_write(tmp_path / "none", "x")
    with pytest.raises(InputError, match="full: cannot be written: No space left on device"):
        atomic_write(tmp_path / "full", "x")
    assert Path("/dev/null").is_char_device()
    assert Path("/dev/full").is_char_device()


def test_a_trial_leaves_nothing_and_the_old_file_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "old").write_text("old")
    for name in ("old", "new", "ä" * 120, "\U0001f69a" * 60):
        check_writable(tmp_path / name)
        atomic_write(tmp_path / name, "old")
    assert (tmp_path / "old").read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 4


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("folder", "is a directory"), ("none/a", "there is no folder"), ("file/a", "there is no folder"),
        ("dangling", "there is no folder"),
        ("loop", "cannot be written"), ("a" * 256, "cannot be written: File name too long"),
    ],
)  # fmt: skip
def test_what_could_not_be_written_fails_its_trial(name: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("x")
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere" / "a")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    for attempt in (check_writable, lambda path: atomic_write(path, "x")):
        with pytest.raises(InputError, match=words):
            attempt(tmp_path / name)


def test_a_full_disk_fails_the_trial(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: str, flags: int) -> int:
        Path(path).touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("waybound.instances.atomic._private", full)
    with pytest.raises(InputError, match="No space left on device"):
        check_writable(tmp_path / "a")
    assert list(tmp_path.iterdir()) == []
