from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from waybound.solvers.children import end_all, watched


def sleeper() -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])


def test_what_is_watched_is_ended_with_its_folder(tmp_path: Path) -> None:
    folder = tmp_path / "work"
    folder.mkdir()
    with watched(process := sleeper(), folder):
        end_all()
        assert process.poll() is not None
    assert not folder.exists()


def test_what_is_no_longer_watched_is_left_alone() -> None:
    with watched(process := sleeper()):
        pass
    end_all()
    assert process.poll() is None
    process.kill()
    process.wait()
