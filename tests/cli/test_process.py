"""The command in a process of its own: exit codes, interrupts, pipes, start."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

import waybound as wb

COMMAND = [sys.executable, "-m", "waybound"]

pytestmark = pytest.mark.timeout(120)


def interrupted_at_first_incumbent(*arguments: str) -> tuple[int, str, float]:
    """Exit code, standard output, and seconds between the interrupt and the end."""
    process = subprocess.Popen([*COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    watchdog = threading.Timer(90, process.kill)
    watchdog.start()
    try:
        assert process.stderr is not None
        for line in process.stderr:
            if "objective" in line:
                break
        process.send_signal(signal.SIGINT)
        began = time.perf_counter()
        out, _ = process.communicate()
        return process.returncode, out, time.perf_counter() - began
    finally:
        watchdog.cancel()
        process.kill()


@pytest.mark.parametrize("solver", ["pyvrp", "ortools"])
def test_an_interrupt_prints_the_best_answer_verified_and_is_exit_0(solver):
    code, out, _ = interrupted_at_first_incumbent("solve", "demo-rc50", "--solver", solver, "--time-limit", "60", "--json")
    data = json.loads(out)
    assert (code, data["limit"], data["certificate"]["feasible"]) == (0, "interrupt", True)
    problem = wb.read("demo-rc50")
    assert problem.evaluate(problem.answer_from_json(data["answer"])).values[0] == pytest.approx(data["objective"])


WAITING = """
import os, signal, sys, threading, time
from waybound.solvers.backend import BACKENDS, Engine, RawResult

class Waiting(Engine):
    name, family, package, modules, summary, features = "waiting", "routing", "waybound", ("json",), "for tests", frozenset()
    def missing(self, problem):
        return frozenset()
    def run(self, problem, options, control):
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        while not control.stopped:
            time.sleep(0.01)
        return RawResult("unknown", limit="interrupt")

BACKENDS.names()
BACKENDS.add("waiting", Waiting)
sys.argv = ["waybound", "solve", "demo-tiny", "--solver", "waiting", "--json", "-q"]
from waybound.cli import main
main()
"""


def test_an_interrupt_without_an_answer_is_exit_130():
    done = subprocess.run([sys.executable, "-c", WAITING], capture_output=True, text=True, timeout=60)
    assert done.returncode == 130, done.stderr
    assert "Traceback" not in done.stderr
    assert json.loads(done.stdout)["answer"] is None


def test_an_interrupt_before_anything_has_begun_is_exit_130_without_a_traceback():
    code = (
        "import os, signal, waybound.cli.app as face\ndef stop(**given): os.kill(os.getpid(), signal.SIGINT)\nface.app = stop\n"
        "import waybound.cli\nwaybound.cli.main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 130
    assert "Traceback" not in done.stderr


def test_an_interrupt_after_the_last_word_does_not_change_the_exit_code():
    code = (
        "import atexit, os, signal, sys\natexit.register(lambda: os.kill(os.getpid(), signal.SIGINT))\n"
        "sys.argv = ['waybound', '--version']\nfrom waybound.cli import main\nmain()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_reader_that_hangs_up_causes_no_traceback():
    process = subprocess.Popen([*COMMAND, "instances", "show", "demo-rc50"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.close()
    _, told = process.communicate(timeout=60)
    assert b"Traceback" not in told
    assert b"internal error" not in told


@pytest.mark.parametrize("arguments", [("--help",), ("--version",), ("solve", "--help"), ("instances", "--help")])
def test_help_and_version_load_no_solver_no_pandas_and_no_scipy(arguments):
    code = (
        "import sys\nfrom waybound.cli import main\n"
        f"sys.argv = ['waybound', *{arguments!r}]\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "print(*{m.split('.')[0] for m in sys.modules}, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not set(done.stderr.split()) & {"highspy", "ortools", "pulp", "cvxpy", "pyvrp", "pandas", "scipy", "matplotlib", "numba"}
    assert done.stdout


def test_checking_a_certificate_loads_no_solver(tmp_path):
    solved = subprocess.run(
        [
            *COMMAND,
            "solve",
            "demo-tiny",
            "--iterations",
            "30",
            "-q",
            "--out",
            str(tmp_path / "a.json"),
            "--certificate",
            str(tmp_path / "c.json"),
        ],
        capture_output=True,
        text=True,
    )
    assert solved.returncode == 0, solved.stderr
    assert json.loads((tmp_path / "c.json").read_text())["bound"] is not None
    code = (
        "import sys\nfrom waybound.cli import main\n"
        f"sys.argv = ['waybound', 'check', 'demo-tiny', {str(tmp_path / 'a.json')!r}, '--certificate', {str(tmp_path / 'c.json')!r}]\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "print(*{m.split('.')[0] for m in sys.modules}, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not set(done.stderr.split()) & {"highspy", "ortools", "pulp", "cvxpy", "pyvrp"}
    assert "verified" in done.stdout


def test_the_version_is_that_of_the_package():
    done = subprocess.run([*COMMAND, "--version"], capture_output=True, text=True, check=True)
    assert done.stdout == f"waybound {wb.__version__}\n"


def test_bad_input_in_a_process_is_exit_2_with_one_line(tmp_path):
    done = subprocess.run([*COMMAND, "solve", str(tmp_path)], capture_output=True, text=True)
    assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 1)


def test_standard_output_in_ascii_does_not_break_the_tables():
    environment = {**os.environ, "COLUMNS": "120", "PYTHONIOENCODING": "ascii", "LC_ALL": "C", "PYTHONUTF8": "0"}
    done = subprocess.run([*COMMAND, "solve", "demo-tiny", "--iterations", "20", "-q"], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert "vehicle 1" in done.stdout
