"""The command of a study: what it makes, and how it ends."""

from __future__ import annotations

from pathlib import Path

import pytest

from waybound.instances.errors import UsageError
from waybound.reports.missions._study_command import study_command


def test_a_folder_is_made_and_the_summary_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = []

    def study(folder: Path, short: bool) -> str:
        asked.append((folder.is_dir(), short))
        return "done\n"

    assert study_command("x", "About.\nMore.", study, ["--out", str(tmp_path / "a" / "b"), "--short"], "days") == 0
    assert asked == [(True, True)] and capsys.readouterr().out == "done\n"


@pytest.mark.parametrize(("fault", "code"), [(UsageError("wrong"), 2), (OSError("full"), 2), (KeyboardInterrupt(), 130)])
def test_faults_are_one_line_and_an_exit_code(fault: BaseException, code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def study(folder: Path, short: bool) -> str:
        raise fault

    assert study_command("x", "About.", study, ["--out", str(tmp_path)], "days") == code
    assert capsys.readouterr().err.count("\n") == 1
