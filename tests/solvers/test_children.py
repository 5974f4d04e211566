import os
import signal
import subprocess
import sys
import tempfile
import textwrap
import time
from pathlib import Path
from typing import IO

import psutil
import pytest

from waybound.solvers import children
from waybound.solvers.children import LOCK, PREFIX, child, end_all, scratch

SLEEP = [sys.executable, "-c", "import time; time.sleep(60)"]


@pytest.fixture(autouse=True)
def private(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for temporary files of its own."""
    folder = tmp_path / "private"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def alive(pid: int) -> bool:
    return psutil.pid_exists(pid) and psutil.Process(pid).status() != psutil.STATUS_ZOMBIE


def within(seconds: float, what) -> bool:
    end = time.monotonic() + seconds
    while not what():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def test_a_child_ends_with_its_block() -> None:
    before = set(psutil.Process().children())  # of earlier tests in this process
    with child(SLEEP) as process:
        assert process.poll() is None
    assert process.returncode == -signal.SIGKILL
    assert set(psutil.Process().children()) <= before


def test_what_a_child_has_started_ends_with_it() -> None:
    code = "import subprocess, sys, time; p = subprocess.Popen(['sleep', '60']); print(p.pid, flush=True); time.sleep(60)"
    with child([sys.executable, "-c", code], stdout=subprocess.PIPE) as process:
        grandchild = int(process.stdout.readline())
        assert alive(grandchild)
        process.stdout.close()
    assert within(5, lambda: not alive(grandchild))


def test_the_code_with_which_a_child_ends_is_its_own() -> None:
    with child([sys.executable, "-c", "raise SystemExit(7)"]) as process:
        assert process.wait(20) == 7
    assert process.returncode == 7


def test_all_children_and_folders_can_be_ended_at_once() -> None:
    with scratch() as folder, child(SLEEP, folder) as process:
        end_all()
        assert process.poll() is not None
        assert not folder.exists()


def test_a_child_that_cannot_be_started_leaves_no_process() -> None:
    with pytest.raises(FileNotFoundError), child(["/no/such/program"]):
        pass
    assert not psutil.Process().children()


PARENT = """
import sys, tempfile, time
from waybound.solvers.children import child, scratch
with scratch() as folder, child([sys.executable, "-c", "import time; time.sleep(60)"], folder, cwd=folder) as process:
    (folder / "big.mps").write_text("rows")
    (folder / "deep").mkdir()
    print(process.pid, folder, flush=True)
    time.sleep(60)
"""


@pytest.mark.parametrize("number", ["SIGKILL", "SIGHUP", "SIGQUIT", "SIGTERM", "SIGINT"])
def test_however_the_parent_ends_its_children_and_their_files_end_with_it(number: str, private: Path, tmp_path: Path) -> None:
    script = tmp_path / "parent.py"
    script.write_text(textwrap.dedent(PARENT))
    environment = {**os.environ, "TMPDIR": str(private)}
    parent = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment)
    pid, folder = parent.stdout.readline().split()
    assert Path(folder, "big.mps").exists()
    parent.send_signal(getattr(signal, number))
    parent.communicate(timeout=20)
    assert within(5, lambda: not alive(int(pid)))
    assert within(5, lambda: not any(private.iterdir()))


def test_a_sweep_while_a_folder_is_being_made_leaves_it(private: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    locked = children._locked

    def swept_first(file: IO[bytes]) -> bool:
        monkeypatch.setattr(children, "_locked", locked)
        children._sweep()
        return locked(file)

    monkeypatch.setattr(children, "_locked", swept_first)
    with scratch() as folder:
        assert folder.is_dir()
        children._sweep()
        assert folder.is_dir()


def test_folders_of_dead_processes_are_swept_and_those_of_living_ones_are_not(private: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dead, young, other = private / f"{PREFIX}dead", private / f"{PREFIX}young", private / "other"
    for folder in (dead, young, other):
        folder.mkdir()
    (dead / LOCK).touch()
    (dead / "model.mps").touch()
    with scratch() as living:
        assert not dead.exists()
        with scratch():
            assert living.exists()
        assert young.exists()
        assert other.exists()
        monkeypatch.setattr(children, "YOUNG", -1.0)
        with scratch():
            assert not young.exists()
            assert living.exists()
    assert [folder.name for folder in private.iterdir()] == ["other"]
